// SPDX-License-Identifier: MIT
#pragma once

#include <cstring>
#include <string_view>

namespace seqloop::live {

/// What an errno means, in words. Allocates: never.
[[nodiscard]] inline std::string_view error_text(int error) noexcept {
  const char* const text = strerrordesc_np(error);
  return text == nullptr ? std::string_view("unknown error") : std::string_view(text);
}

}  // namespace seqloop::live
