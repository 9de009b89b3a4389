// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

namespace seqloop {

/// What is usual in a drive: a mean that starts as if some values had been seen, and to which the
/// newest adds 1/200 in the end.
class Usual {
 public:
  /// @param seen how many, at least 0
  explicit Usual(double at_first, double seen = 20.0) noexcept : mean_(at_first), seen_(seen) {}

  void take(double value) noexcept {
    constexpr double memory = 200.0;
    seen_ = std::min(seen_ + 1.0, memory);
    mean_ += (value - mean_) / seen_;
  }

  [[nodiscard]] double mean() const noexcept { return mean_; }

 private:
  double mean_;
  double seen_;
};

}  // namespace seqloop
