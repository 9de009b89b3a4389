// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::opencv {

/// The descriptor that needs no model file: oriented gradients, a fixed filter bank without
/// training (made by platform/opencv/model), which is compiled into the program. It sees grey only.
/// Throws SetupError only when this OpenCV cannot read the model that was built in.
[[nodiscard]] std::unique_ptr<DnnDescriber> make_builtin_describer();

}  // namespace seqloop::opencv
