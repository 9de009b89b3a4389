// SPDX-License-Identifier: MIT
#include "opencv/detail/natural_order.hpp"

#include <algorithm>

namespace seqloop::opencv {
namespace {

constexpr std::string_view digits = "0123456789";

/// The run of digits at the start, without leading zeros; taken off the text.
std::string_view take_number(std::string_view& text) noexcept {
  const std::size_t length = std::min(text.find_first_not_of(digits), text.size());
  std::string_view number = text.substr(0, length);
  text.remove_prefix(length);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

bool starts_with_digit(std::string_view text) noexcept {
  return !text.empty() && digits.find(text.front()) != std::string_view::npos;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) noexcept {
  std::string_view x = a;
  std::string_view y = b;
  while (!x.empty() && !y.empty()) {
    if (starts_with_digit(x) && starts_with_digit(y)) {
      const std::string_view m = take_number(x);
      const std::string_view n = take_number(y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (x.front() != y.front())
        return static_cast<unsigned char>(x.front()) < static_cast<unsigned char>(y.front());
      x.remove_prefix(1);
      y.remove_prefix(1);
    }
  }
  if (x.empty() != y.empty()) return x.empty();
  return a < b;
}

}  // namespace seqloop::opencv
