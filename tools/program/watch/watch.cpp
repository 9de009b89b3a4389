// SPDX-License-Identifier: MIT
#include "program/watch/watch.hpp"

#include <algorithm>
#include <chrono>

namespace seqloop::program {
namespace {

constexpr Nanoseconds between_pictures = std::chrono::milliseconds(100);

void add(StageCounts& stage, Nanoseconds took) noexcept {
  const double ms = std::chrono::duration<double, std::milli>(took).count();
  const auto bucket = std::ranges::lower_bound(bucket_ms, ms) - bucket_ms.begin();
  ++stage.in[static_cast<std::size_t>(bucket)];
  stage.sum += took;
}

}  // namespace

void Watch::count(const RunSummary& summary) noexcept {
  RunCounts& counts = next_.counts;
  counts.frames = summary.frames();
  for (std::size_t gate = 0; gate < gates; ++gate) {
    counts.at[gate] = summary.at(static_cast<Gate>(gate));
  }
  counts.misses = summary.misses();
  std::ranges::transform(summary.missed(), counts.missed.begin(),
                         [](const auto& limit) { return limit.second; });
  counts.dropped = summary.dropped();
  counts.lost = summary.lost();
  counts.overloaded = summary.overloaded();
}

void Watch::publish(const ProcessedFrame& processed, const LoopState& state,
                    const RunSummary& summary, const MapState& map, Nanoseconds moment) noexcept {
  publish(processed.report.answers);
  count(summary);
  if (processed.report.gate != Gate::no_frame) {
    const StageTimes& times = processed.times;
    add(next_.counts.stages[0], times.grab);
    add(next_.counts.stages[1], times.describe);
    add(next_.counts.stages[2], times.match);
    add(next_.counts.stages[3], times.total);
  }
  next_.frame = processed;
  next_.frame.frame.image = {};
  next_.frame.frame.descriptor = {};
  next_.frame.frame.fault = {};
  next_.frame.frame.remark = {};
  next_.frame.descriptor = {};
  next_.frame.fault = {};
  next_.frame.report.answers = {};
  next_.fault.assign({processed.fault});
  next_.remark.assign({processed.frame.remark});
  next_.state = state;
  next_.map = map;
  if (!frames_.push(next_)) unseen_.fetch_add(1, std::memory_order_relaxed);
  publish_picture(processed, moment);
}

void Watch::publish(std::span<const Answer> answers) noexcept {
  for (const Answer& answer : answers) {
    if (!answers_.push(answer)) unseen_.fetch_add(1, std::memory_order_relaxed);
  }
}

void Watch::end(std::span<const Answer> answers, const RunSummary& summary) noexcept {
  publish(answers);
  count(summary);
  ended_.store(true, std::memory_order_release);
}

void Watch::publish(std::span<const OtherLoop> loops) noexcept {
  for (const OtherLoop& loop : loops) {
    if (!loops_.push(loop)) unseen_.fetch_add(1, std::memory_order_relaxed);
  }
}

void Watch::publish_picture(const ProcessedFrame& processed, Nanoseconds moment) noexcept {
  const std::uint64_t number = processed.report.newest;
  const bool kept = number % wishes.every.load(std::memory_order_relaxed) == 0;
  const bool due = !picture_at_ || moment - *picture_at_ >= between_pictures;
  if (!kept && !(due && wishes.pictures.load(std::memory_order_relaxed))) return;
  if (!shrink(processed.frame.image, number, picture_)) return;
  picture_at_ = moment;
  // Where there is no room, the next one will be as good.
  static_cast<void>(pictures_.push(picture_));
}

}  // namespace seqloop::program
