// SPDX-License-Identifier: MIT
#include "seqloop/detail/running_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "seqloop/detail/lane_sums.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {

RunningStatistics::RunningStatistics(Arena& arena, std::size_t descriptor_size,
                                     const StatisticsNames& names)
    : mean_(arena.take<double>(names.mean, descriptor_size)),
      variance_(arena.take<double>(names.variance, descriptor_size)),
      deviation_(arena.take<float>(names.deviation, descriptor_size)),
      last_taken_(arena.take<float>(names.last_taken, descriptor_size)) {}

void RunningStatistics::observe(std::span<const float> descriptor) noexcept {
  const double weight = 1.0 / static_cast<double>(frames_ + 1);
  observe_weighted(descriptor, weight, weight);
}

void RunningStatistics::follow(std::span<const float> descriptor,
                               const Standardisation& how) noexcept {
  if (frames_ == 0) guess(descriptor, how.prior_frames);
  // Two frames that have nothing to do with each other are on average twice the sum of the
  // variances apart, squared. A tenth of that is a scene that has changed.
  constexpr double changed = 0.1 * 2.0;
  if (squared_distance(last_taken_, descriptor) < changed * variances_) return;
  const auto weight = [&how](std::size_t frames) {
    return 1.0 / static_cast<double>(std::min(frames + 1, how.horizon));
  };
  observe_weighted(descriptor, weight(frames_ - guessed_), weight(frames_));
  std::ranges::copy(descriptor, last_taken_.begin());
}

void RunningStatistics::guess(std::span<const float> descriptor, std::size_t frames) noexcept {
  const auto size = static_cast<double>(descriptor.size());
  const double mean =
      sum_in_lanes(descriptor.size(),
                   [&](std::size_t d) { return static_cast<double>(descriptor[d]); }) /
      size;
  const double variance = sum_in_lanes(descriptor.size(),
                                       [&](std::size_t d) {
                                         const double difference =
                                             static_cast<double>(descriptor[d]) - mean;
                                         return difference * difference;
                                       }) /
                          size;
  // What all frames have in common is as likely the first one's profile as nothing, and so they
  // vary less than its values do among themselves.
  constexpr double varies_less = 0.25;
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    mean_[d] = 0.5 * (mean + static_cast<double>(descriptor[d]));
  }
  std::ranges::fill(variance_, varies_less * variance);
  sum_up();
  frames_ = frames;
  guessed_ = frames > 0 ? frames - 1 : 0;
}

void RunningStatistics::observe_weighted(std::span<const float> descriptor, double of_mean,
                                         double weight) noexcept {
  const double rest = 1.0 - weight;
  double* mean = mean_.data();
  double* variance = variance_.data();
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double difference = static_cast<double>(descriptor[d]) - mean[d];
    mean[d] += of_mean * difference;
    variance[d] = rest * (variance[d] + weight * difference * difference);
  }
  sum_up();
  ++frames_;
}

void RunningStatistics::sum_up() noexcept {
  for (std::size_t d = 0; d < variance_.size(); ++d) {
    deviation_[d] = std::sqrt(static_cast<float>(variance_[d]));
  }
  variances_ = sum_in_lanes(variance_.size(), [&](std::size_t d) { return variance_[d]; });
  deviations_ = sum_in_lanes(deviation_.size(),
                             [&](std::size_t d) { return static_cast<double>(deviation_[d]); });
}

void RunningStatistics::start_from(const RunningStatistics& other, std::size_t frames) noexcept {
  std::ranges::copy(other.mean_, mean_.begin());
  std::ranges::copy(other.variance_, variance_.begin());
  std::ranges::fill(last_taken_, 0.0F);
  sum_up();
  frames_ = std::min(frames, other.frames_);
  guessed_ = 0;
}

bool RunningStatistics::restore(std::span<const double> mean, std::span<const double> variance,
                                std::uint64_t frames) noexcept {
  const auto sound = [](double value) { return std::isfinite(value); };
  if (mean.size() != mean_.size() || variance.size() != variance_.size() ||
      !std::ranges::all_of(mean, sound) ||
      !std::ranges::all_of(variance, [&](double v) { return sound(v) && v >= 0.0; })) {
    return false;
  }
  std::ranges::copy(mean, mean_.begin());
  std::ranges::copy(variance, variance_.begin());
  sum_up();
  frames_ = static_cast<std::size_t>(
      std::min<std::uint64_t>(frames, std::numeric_limits<std::size_t>::max()));
  guessed_ = 0;
  return true;
}

bool RunningStatistics::standardise(std::span<const float> descriptor,
                                    std::span<float> out) const noexcept {
  // A feature that hardly ever moves would be all noise if it were divided by its own deviation.
  constexpr double floor_share = 0.1;
  // What all frames show alike, as the robot's own bonnet, is large for how little it moves: in a
  // vector of unit length, by how much else there is to see.
  constexpr double steady_share = 0.125;
  if (deviations_ <= 0.0) {
    std::ranges::fill(out.first(mean_.size()), 0.0F);
    return false;
  }
  const double floor = floor_share * deviations_ / static_cast<double>(deviation_.size());
  for (std::size_t d = 0; d < mean_.size(); ++d) {
    const double difference = static_cast<double>(descriptor[d]) - mean_[d];
    const auto least = static_cast<float>(std::max(floor, steady_share * std::abs(mean_[d])));
    out[d] = static_cast<float>(difference) / std::max(deviation_[d], least);
  }
  return normalise(out.first(mean_.size()));
}

}  // namespace seqloop
