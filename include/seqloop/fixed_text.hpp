// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace seqloop {

/// A short message in fixed memory, cut where it is too long.
class FixedText {
 public:
  static constexpr std::size_t capacity = 240;

  FixedText() noexcept = default;

  /// Puts the parts one behind the other. Allocates: never.
  void assign(std::initializer_list<std::string_view> parts) noexcept {
    size_ = 0;
    for (const std::string_view part : parts) append(part);
  }
  void append(std::string_view part) noexcept {
    const std::size_t taken = std::min(part.size(), capacity - size_);
    std::copy_n(part.begin(), taken, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += taken;
  }
  void append_number(std::uint64_t number) noexcept {
    std::array<char, 20> digits;  // as many as the largest has
    const char* end = std::to_chars(digits.begin(), digits.end(), number).ptr;
    append({digits.begin(), end});
  }
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] std::string_view view() const noexcept { return {text_.data(), size_}; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

 private:
  std::array<char, capacity> text_{};
  std::size_t size_ = 0;
};

}  // namespace seqloop
