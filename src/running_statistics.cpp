#include "seqloop/running_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "seqloop/difference.hpp"

namespace seqloop {

RunningStatistics::RunningStatistics(Arena& arena, std::size_t descriptor_size)
    : mean_(arena.take<double>("mean of each feature", descriptor_size)),
      variance_(arena.take<double>("variance of each feature", descriptor_size)),
      last_taken_(arena.take<float>("last frame that moved the statistics", descriptor_size)) {}

void RunningStatistics::observe(std::span<const float> descriptor) noexcept {
  observe_weighted(descriptor, 1.0 / static_cast<double>(frames_ + 1));
}

void RunningStatistics::follow(std::span<const float> descriptor, std::size_t horizon) noexcept {
  // Two frames that have nothing to do with each other are on average twice the sum of the
  // variances apart, squared. A tenth of that is a scene that has changed.
  constexpr double changed = 0.1 * 2.0;
  double apart = 0.0;
  double variances = 0.0;
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double difference =
        static_cast<double>(descriptor[d]) - static_cast<double>(last_taken_[d]);
    apart += difference * difference;
    variances += variance_[d];
  }
  if (apart < changed * variances) return;
  observe_weighted(descriptor, 1.0 / static_cast<double>(std::min(frames_ + 1, horizon)));
  std::ranges::copy(descriptor, last_taken_.begin());
}

void RunningStatistics::start_flat(std::span<const float> descriptor, std::size_t frames) noexcept {
  const auto size = static_cast<double>(descriptor.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const float value : descriptor) sum += static_cast<double>(value);
  for (const float value : descriptor) {
    const double difference = static_cast<double>(value) - sum / size;
    squares += difference * difference;
  }
  std::ranges::fill(mean_, sum / size);
  std::ranges::fill(variance_, squares / size);
  frames_ = frames;
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
  // A feature that hardly ever moves would be all noise if it were divided by its own deviation.
  constexpr double floor_share = 0.1;
  double deviations = 0.0;
  for (const double variance : variance_) deviations += std::sqrt(variance);
  const double floor = floor_share * deviations / static_cast<double>(variance_.size());
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double deviation = std::max(std::sqrt(variance_[d]), floor);
    const double difference = static_cast<double>(descriptor[d]) - mean_[d];
    out[d] = deviation > 0.0 ? static_cast<float>(difference / deviation) : 0.0F;
  }
  return normalise(out.first(mean_.size()));
}

}  // namespace seqloop
