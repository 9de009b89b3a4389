// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop::opencv {

using Bytes = std::span<const std::uint8_t>;

/// Whether the text stands there; not where the bytes end before.
[[nodiscard]] inline bool has(Bytes bytes, std::size_t place, std::string_view text) noexcept {
  return place <= bytes.size() && text.size() <= bytes.size() - place &&
         std::ranges::equal(bytes.subspan(place, text.size()), text, [](std::uint8_t a, char b) {
           return a == static_cast<std::uint8_t>(b);
         });
}

/// A number of four bytes. @return 0 where the bytes end before
[[nodiscard]] inline std::uint32_t little_endian(Bytes bytes, std::size_t place) noexcept {
  if (place > bytes.size() || bytes.size() - place < 4) return 0;
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[place + i];
  return value;
}

}  // namespace seqloop::opencv
