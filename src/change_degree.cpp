// SPDX-License-Identifier: MIT
#include "seqloop/detail/change_degree.hpp"

#include <limits>

namespace seqloop {

double ChangeDegree::advance(const QueryHistory& queries, std::uint64_t frame) noexcept {
  distances_ = 0;
  if (frame < reach) return 1.0;
  double sum = 0.0;
  for (std::uint64_t earlier = frame - reach; earlier < frame; ++earlier) {
    sum += static_cast<double>(queries.between(frame, earlier));
    ++distances_;
  }
  // The denominator of Eq. (4) is the numerator of the frame before.
  const std::optional<double> denominator = last_sum_;
  last_sum_ = sum;
  if (!denominator) return 1.0;
  if (*denominator > 0.0) return sum / *denominator;
  return sum > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
}

}  // namespace seqloop
