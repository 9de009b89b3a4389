// SPDX-License-Identifier: MIT
#include "program/run/closures_bag.hpp"

#include <cmath>

namespace seqloop::program {

ClosuresBag::ClosuresBag(const std::filesystem::path& path)
    : out_(path),
      bag_([this](std::span<const std::uint8_t> bytes) { out_.write(std::as_bytes(bytes)); }) {}

void ClosuresBag::begin(std::int64_t start_ns, bool own_places) noexcept {
  start_ns_ = start_ns;
  own_places_ = own_places;
}

void ClosuresBag::add(std::span<const Answer> answers, const FrameTimes& times) {
  const auto stamp_of = [&](double time_s) { return start_ns_ + std::llround(time_s * 1e9); };
  const auto stamp = [&](std::uint64_t frame) {
    const std::optional<double> time_s = times.at(frame);
    return time_s ? stamp_of(*time_s) : 0;
  };
  for (const Answer& answer : answers) {
    if (answer.gate != Gate::match || !answer.match) continue;
    bag_.add({.stamp_ns = stamp(answer.frame),
              .match_stamp_ns = own_places_ ? stamp(answer.match->place) : 0,
              .frame = answer.frame,
              .match = answer.match->place,
              .session = {},
              .probability = static_cast<double>(answer.probability),
              .uniqueness = static_cast<double>(answer.match->uniqueness),
              .score = static_cast<double>(answer.match->score),
              .velocity = static_cast<double>(answer.match->velocity)},
             stamp_of(times.newest_s()));
  }
}

void ClosuresBag::commit() {
  bag_.finish();
  out_.commit();
}

}  // namespace seqloop::program
