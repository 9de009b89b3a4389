// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "seqloop/frame.hpp"

namespace seqloop {

/// What is wrong with the format of a picture; empty where it is one of the values there are.
[[nodiscard]] constexpr std::string_view format_fault(PixelFormat format) noexcept {
  const bool known = format == PixelFormat::gray8 || format == PixelFormat::bgr8;
  return known ? "" : "the picture's format is none of its values: take gray8 or bgr8";
}

}  // namespace seqloop
