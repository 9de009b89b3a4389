// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "program/drives/small_picture.hpp"
#include "program/run/other_loop.hpp"
#include "program/run/run_summary.hpp"
#include "seqloop/fixed_text.hpp"
#include "seqloop/linux/detail/return_queue.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {

/// Upper ends of the buckets in which durations are counted, in milliseconds; the last one has
/// none.
inline constexpr std::array<double, 13> bucket_ms{.1, .2, .5,  1,   2,   5,   10,
                                                  20, 40, 100, 200, 500, 1000};

/// Names of the stages, as `run` has them.
inline constexpr std::array<const char*, 4> stage_names{"grab", "describe", "match", "total"};

/// How long a stage took, over the whole run.
struct StageCounts {
  std::array<std::uint64_t, bucket_ms.size() + 1> in{};  ///< frames by bucket, each counted once
  Nanoseconds sum{0};
};

/// What a run has counted so far.
struct RunCounts {
  std::uint64_t frames = 0;
  std::array<std::uint64_t, gates> at{};  ///< by gate, as `RunSummary::at`
  std::uint64_t misses = 0;
  std::array<std::uint64_t, 5> missed{};  ///< age, describe, grab, match, total
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;
  std::uint64_t overloaded = 0;
  std::array<StageCounts, stage_names.size()> stages{};
};

/// How the map stands.
struct MapState {
  std::size_t places = 0;
  std::uint64_t saved = 0;  ///< frames of the drive that are on the disk for good
  std::optional<std::size_t> of_others = std::nullopt;  ///< places of other robots; none: no fleet
  /// The number that the newest frame has as a place, or would have; none: places are of others
  std::optional<std::uint64_t> newest = std::nullopt;
};

/// All that is shown of a frame, in fixed memory.
struct Snapshot {
  ProcessedFrame frame;  ///< without its picture, descriptor, answers and texts
  LoopState state;
  FixedText fault;
  FixedText remark;
  RunCounts counts;
  MapState map;
};

/// A picture on its way to whoever looks.
using SmallPicture = PictureWithin<160, 120>;

/// What people wish of a loop. Set by any thread; the loop looks before each frame.
struct Wishes {
  std::atomic<bool> pause{false};
  std::atomic<bool> stop{false};
  std::atomic<float> min_probability{0.0F};  ///< 0: as configured
  std::atomic<bool> pictures{false};         ///< somebody looks, so that each frame's is wanted
  std::atomic<std::uint64_t> every{1};       ///< frames of which one picture is kept
};

/// From a loop to whoever watches it: neither waits for the other. What finds no room, because
/// nobody took what was there, is counted and left out.
class Watch {
 public:
  /// The loop's side. Work: a copy of a frame's numbers, at most a small picture.
  /// Allocates: never. System calls: none.
  /// @param moment now, on the loop's clock: pictures for who looks come ten times a second
  void publish(const ProcessedFrame& processed, const LoopState& state, const RunSummary& summary,
               const MapState& map, Nanoseconds moment) noexcept;
  void publish(std::span<const Answer> answers) noexcept;
  /// Answers that were due at the end, and what they make of the counts. No frame comes after it.
  void end(std::span<const Answer> answers, const RunSummary& summary) noexcept;
  /// Loops with other robots.
  void publish(std::span<const OtherLoop> loops) noexcept;

  // The watcher's side, one thread.
  using Frames = live::ReturnQueue<Snapshot, 512>;
  using Answers = live::ReturnQueue<Answer, 8192>;
  using Loops = live::ReturnQueue<OtherLoop, 512>;
  using Pictures = live::ReturnQueue<SmallPicture, 32>;
  [[nodiscard]] Frames& frames() noexcept { return frames_; }
  [[nodiscard]] Answers& answers() noexcept { return answers_; }
  [[nodiscard]] Loops& loops() noexcept { return loops_; }
  [[nodiscard]] Pictures& pictures() noexcept { return pictures_; }
  /// What the whole run has counted; null while it goes on. Once it is there, all frames are.
  [[nodiscard]] const RunCounts* last_counts() const noexcept {
    return ended_.load(std::memory_order_acquire) ? &next_.counts : nullptr;
  }
  /// Frames, answers and loops that found no room.
  [[nodiscard]] std::uint64_t unseen() const noexcept { return unseen_; }

  Wishes wishes;

 private:
  void count(const RunSummary& summary) noexcept;
  void publish_picture(const ProcessedFrame& processed, Nanoseconds moment) noexcept;

  Frames frames_;
  Answers answers_;
  Loops loops_;
  Pictures pictures_;
  std::atomic<std::uint64_t> unseen_{0};
  std::atomic<bool> ended_{false};

  // The loop's.
  Snapshot next_;
  SmallPicture picture_;
  std::optional<Nanoseconds> picture_at_;
};

}  // namespace seqloop::program
