// SPDX-License-Identifier: MIT
#include "synthetic/driven_detector.hpp"

#include <algorithm>
#include <cmath>

#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/difference.hpp"

namespace seqloop::program {
namespace {

// What is seen again differs from the map by as much as it resembles it.
constexpr float noise = 1.0F;

PlaceMap synthetic_map(SyntheticPlaces& places, const MatcherConfig& config,
                       const Capacity& capacity) {
  PlaceMap map(config, capacity);
  std::vector<float> descriptor(capacity.descriptor_size);
  double place = 0.0;
  do {
    places.see(place++, 0.0F, descriptor);
  } while (map.add(descriptor) && map.size() < capacity.places);
  return map;
}

}  // namespace

std::uint64_t DrivenDetector::bytes_needed(const MatcherConfig& config, const Capacity& capacity) {
  return PlaceMap::bytes_needed(config, capacity) + Detector::bytes_needed(config, capacity);
}

DrivenDetector::DrivenDetector(const MatcherConfig& config, const Capacity& capacity)
    : stored_bytes_(config.arithmetic == Arithmetic::int8
                        ? padded_bytes(capacity.descriptor_size)
                        : padded_size(capacity.descriptor_size) * sizeof(float)),
      places_(capacity.descriptor_size),
      robot_(capacity.places),
      map_(synthetic_map(places_, config, capacity)),
      detector_(config, map_),
      descriptor_(capacity.descriptor_size) {
  for (std::size_t frame = 0; frame < config.sequence_length; ++frame) {
    drive();
    step();
  }
  steps_ = distances_ = scanned_ = sketches_ = answered_ = found_ = 0;
}

void DrivenDetector::drive() {
  positions_.push_back(robot_.next());
  places_.see(positions_.back(), noise, descriptor_);
}

void DrivenDetector::step() noexcept {
  const FrameReport report = detector_.step(descriptor_);
  ++steps_;
  distances_ += report.work.distances;
  scanned_ += report.work.scanned;
  sketches_ += report.work.sketches;
  for (const Answer& answer : report.answers) {
    ++answered_;
    if (answer.gate != Gate::match) continue;
    constexpr double tolerance = 5.0;
    const double place = static_cast<double>(answer.match->place);
    found_ += std::abs(place - positions_[static_cast<std::size_t>(answer.frame)]) <= tolerance;
  }
}

std::uint64_t DrivenDetector::bytes_a_step() const noexcept {
  constexpr std::size_t word = sizeof(std::uint64_t);
  return (distances_ * stored_bytes_ + scanned_ * DescriptorRows::scanned_words * word +
          sketches_ * DescriptorRows::close_words * word) /
         std::max<std::uint64_t>(steps_, 1);
}

double DrivenDetector::found() const noexcept {
  return static_cast<double>(found_) / static_cast<double>(std::max<std::uint64_t>(answered_, 1));
}

}  // namespace seqloop::program
