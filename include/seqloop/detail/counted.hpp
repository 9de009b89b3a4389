// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace seqloop {

/// `1 frame`, `2 frames`: for messages. Allocates: yes.
/// @param thing one of them @param more what several of them end with
[[nodiscard]] inline std::string counted(std::uint64_t count, std::string_view thing,
                                         std::string_view more = "s") {
  std::string text = std::to_string(count) + ' ';
  text += thing;
  if (count != 1) text += more;
  return text;
}

/// What goes with so many: `is` or `are`.
[[nodiscard]] constexpr std::string_view are(std::uint64_t count) noexcept {
  return count == 1 ? "is" : "are";
}

}  // namespace seqloop
