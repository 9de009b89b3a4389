// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/describer.hpp"
#include "seqloop/opencv/dnn_describer.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::opencv {

/// The descriptor that needs no model file: oriented gradients, a fixed filter bank without
/// training. It sees grey only. Of the same 256x128 grey pixels it makes the same bytes on every
/// processor. Describing allocates nothing where a grey picture keeps its size and shrinks.
[[nodiscard]] std::unique_ptr<Describer> make_builtin_describer();

/// The same as a net that OpenCV computes (made by platform/opencv/model and compiled in), within
/// 1e-6, for what works around nets: several times as slow.
/// Throws SetupError only when this OpenCV cannot read the model that was built in.
[[nodiscard]] std::unique_ptr<DnnDescriber> make_builtin_net();

/// Tells a map what values of the built-in descriptor usually are, so that a first drive that
/// closes loops in it starts from that, and not from its first frame alone (src/README.md,
/// section 5.1), and in how many columns they stand (section 5.13).
/// @return false for a map that has places or statistics already, whose descriptors are of another
///   size, or that does not standardise: then nothing has changed
/// Work: 735 values. Allocates: never.
bool expect_builtin(PlaceMap& map) noexcept;

}  // namespace seqloop::opencv
