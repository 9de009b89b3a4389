// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <span>

namespace seqloop {

/// Takes a value into a list in rising order, behind its equals. In a full list the highest makes
/// room, be it the value itself.
/// @param list  room for as many as are kept
/// @param count how many it holds
/// @param key   what they are ordered by: a member
/// @return how many it holds then. Work: a binary search and a move. Allocates: never.
template <class Value, class Key>
std::size_t keep_lowest(std::span<Value> list, std::size_t count, const Value& value,
                        Key key) noexcept {
  const std::size_t grown = std::min(count + 1, list.size());
  const auto begin = list.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  const auto place = std::ranges::upper_bound(begin, end, std::invoke(key, value), {}, key);
  const auto last = begin + static_cast<std::ptrdiff_t>(grown);
  if (place == last) return grown;
  std::move_backward(place, last - 1, last);
  *place = value;
  return grown;
}

}  // namespace seqloop
