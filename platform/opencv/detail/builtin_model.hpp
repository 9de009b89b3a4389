// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace seqloop::opencv {

/// The ONNX file that embed.cmake turned into code.
[[nodiscard]] std::span<const unsigned char> builtin_model() noexcept;

}  // namespace seqloop::opencv
