// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>

namespace seqloop {

/// Chooses configurations by chance, the same at every run.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}

  std::size_t between(std::size_t low, std::size_t high) {
    return low + random_() % (high - low + 1);
  }
  bool one_in(std::size_t n) { return between(1, n) == 1; }
  template <class Value>
  Value one_of(std::initializer_list<Value> values) {
    return values.begin()[between(0, values.size() - 1)];
  }

 private:
  std::mt19937 random_;
};

}  // namespace seqloop
