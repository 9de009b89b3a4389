// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/describer.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::opencv {

/// The descriptor that needs no model file: oriented gradients, a fixed filter bank without
/// training. It sees grey only. Of the same 128x64 grey pixels it makes the same bytes on every
/// processor. Describing allocates nothing where a grey picture keeps its size and shrinks.
[[nodiscard]] std::unique_ptr<Describer> make_builtin_describer();

/// The same as a net that OpenCV computes (made by platform/opencv/model and compiled in), within
/// 1e-6, for what works around nets: several times as slow.
/// Throws SetupError only when this OpenCV cannot read the model that was built in.
[[nodiscard]] std::unique_ptr<DnnDescriber> make_builtin_net();

}  // namespace seqloop::opencv
