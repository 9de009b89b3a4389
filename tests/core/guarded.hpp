// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "guarded_bytes.hpp"

namespace seqloop::test {

/// Memory that ends with the values: a value too far ends the program.
template <class Value>
class Guarded {
 public:
  explicit Guarded(const std::vector<Value>& values) : memory_(values.size() * sizeof(Value)) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    held_ = memory_.hold({bytes, values.size() * sizeof(Value)}).data();
  }
  [[nodiscard]] const Value* data() const {
    return static_cast<const Value*>(static_cast<const void*>(held_));
  }

 private:
  GuardedBytes memory_;
  const std::uint8_t* held_;
};

}  // namespace seqloop::test
