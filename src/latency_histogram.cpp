// SPDX-License-Identifier: MIT
#include "seqloop/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace seqloop {

void LatencyHistogram::add(Nanoseconds duration) noexcept {
  const auto value = static_cast<std::uint64_t>(std::max<Nanoseconds::rep>(duration.count(), 0));
  // The first 2^(bits + 1) values have a bucket each; from there the top bits name the bucket.
  const auto width = static_cast<unsigned>(std::bit_width(value));
  const unsigned shift = width > steps_bits + 1 ? width - steps_bits - 1 : 0;
  ++buckets_[shift * steps + static_cast<std::size_t>(value >> shift)];
  ++count_;
  maximum_ = std::max(maximum_, Nanoseconds(static_cast<Nanoseconds::rep>(value)));
}

Nanoseconds LatencyHistogram::longest_in(std::size_t bucket) noexcept {
  const std::size_t shift = bucket < 2 * steps ? 0 : bucket / steps - 1;
  const std::uint64_t next = (static_cast<std::uint64_t>(bucket - shift * steps) + 1) << shift;
  return Nanoseconds(static_cast<Nanoseconds::rep>(next - 1));
}

Nanoseconds LatencyHistogram::quantile(double share) const noexcept {
  const double within = share > 0.0 ? std::min(share, 1.0) : 0.0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(within * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t bucket = 0; bucket < buckets_.size(); ++bucket) {
    seen += buckets_[bucket];
    if (seen < wanted || seen == 0) continue;
    return std::min(maximum_, longest_in(bucket));
  }
  return maximum_;
}

}  // namespace seqloop
