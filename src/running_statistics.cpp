#include "seqloop/running_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "seqloop/difference.hpp"

namespace seqloop {

RunningStatistics::RunningStatistics(Arena& arena, std::size_t descriptor_size)
    : mean_(arena.take<double>("mean of each feature", descriptor_size)),
      variance_(arena.take<double>("variance of each feature", descriptor_size)) {}

void RunningStatistics::observe(std::span<const float> descriptor) noexcept {
  observe_weighted(descriptor, 1.0 / static_cast<double>(frames_ + 1));
}

void RunningStatistics::observe(std::span<const float> descriptor, std::size_t horizon) noexcept {
  observe_weighted(descriptor, 1.0 / static_cast<double>(std::min(frames_ + 1, horizon)));
}

void RunningStatistics::observe_weighted(std::span<const float> descriptor,
                                         double weight) noexcept {
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double difference = static_cast<double>(descriptor[d]) - mean_[d];
    mean_[d] += weight * difference;
    variance_[d] = (1.0 - weight) * (variance_[d] + weight * difference * difference);
  }
  ++frames_;
}

void RunningStatistics::start_from(const RunningStatistics& other, std::size_t frames) noexcept {
  std::ranges::copy(other.mean_, mean_.begin());
  std::ranges::copy(other.variance_, variance_.begin());
  frames_ = std::min(frames, other.frames_);
}

bool RunningStatistics::standardise(std::span<const float> descriptor,
                                    std::span<float> out) const noexcept {
  // A constant feature gathers a variance of rounding errors; dividing by it would make noise loud.
  constexpr double rounding = 1e-12;
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double difference = static_cast<double>(descriptor[d]) - mean_[d];
    const bool deviates = variance_[d] > rounding * (1e-6 + mean_[d] * mean_[d]);
    out[d] = deviates ? static_cast<float>(difference / std::sqrt(variance_[d])) : 0.0F;
  }
  return normalise(out.first(mean_.size()));
}

}  // namespace seqloop
