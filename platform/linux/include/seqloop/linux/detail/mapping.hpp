// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// A device's memory seen from here, with one owner, who unmaps it.
class Mapping {
 public:
  Mapping(SystemCalls& system, void* address, std::size_t length) noexcept
      : system_(&system), address_(address), length_(length) {}
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  Mapping(Mapping&& other) noexcept
      : system_(other.system_),
        address_(std::exchange(other.address_, nullptr)),
        length_(std::exchange(other.length_, 0)) {}
  Mapping& operator=(Mapping&&) = delete;
  ~Mapping() { reset(); }

  /// Empty once it is unmapped.
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {static_cast<const std::uint8_t*>(address_), length_};
  }

  void reset() noexcept {
    if (address_ != nullptr) system_->unmap(std::exchange(address_, nullptr), length_);
    length_ = 0;
  }

 private:
  SystemCalls* system_;
  void* address_;
  std::size_t length_;
};

}  // namespace seqloop::live
