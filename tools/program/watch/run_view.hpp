// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program/map/verdict.hpp"
#include "program/watch/watch.hpp"
#include "seqloop/latency_histogram.hpp"

namespace seqloop::program {

/// An accepted match.
struct Loop {
  std::uint64_t frame = 0;
  std::uint64_t match = 0;  ///< the place
  double time_s = 0.0;      ///< of the frame
  float probability = 0.0F;
  float uniqueness = 0.0F;
  Verdict verdict = Verdict::none;
  /// Of another robot's place, which of those sessions it is of; `match` is its frame there.
  std::optional<std::uint32_t> other = std::nullopt;
};

/// A place that a person marked.
struct Mark {
  std::uint64_t frame = 0;
  std::string name;
};

/// What was wrong with frames one after the other.
struct Trouble {
  std::optional<std::uint64_t> frame;  ///< the newest of them; none where no frame came
  std::uint64_t times = 0;
  std::string text;
};

/// A run as somebody sees it who looks from outside, in bounded memory: what is going on, what was
/// answered, how long it took. Fed with snapshots of a run that goes on, or with the lines of one
/// that is over. No thread of its own, no lock.
class RunView {
 public:
  static constexpr std::size_t most_loops = 250'000;  ///< that are listed: 12 MB
  static constexpr std::size_t most_answers = 6'000;  ///< of the whole run, thinned out evenly
  static constexpr std::size_t most_frames = 300;     ///< newest ones, whose times are shown
  static constexpr std::size_t most_marks = 1'000;
  static constexpr std::size_t most_name = 80;  ///< bytes of a mark's name
  static constexpr std::size_t most_troubles = 20;
  static constexpr double patience_s = 10.0;  ///< until it is ill

  /// @param run what the run was started with: `source`, `method`, `min_probability`, `budget_ms`,
  ///   and so on, as the page of the room `platform/http` lists them
  explicit RunView(nlohmann::ordered_json run) : run_(std::move(run)) {}

  /// @param now_s seconds on any clock that goes on
  void take(const Snapshot& snapshot, double now_s);
  void take(const Answer& answer);
  void take(const OtherLoop& loop);
  /// What the whole run has counted; the newest frame stays what it is.
  void take(const RunCounts& counts) { newest_.counts = counts; }
  /// @param frames that are on the disk for good, newer than the newest snapshot's
  void take_saved(std::uint64_t frames) { newest_.map.saved = frames; }

  /// The run is paused: no frame is due, and no time counts as trouble.
  void pause(double now_s);

  /// Since when nothing has come, or the budget has been missed. @return why the run is ill; empty
  /// where it is well
  [[nodiscard]] std::string trouble(double now_s) const;

  [[nodiscard]] nlohmann::ordered_json status() const;
  /// All that is shown of the past: `frames` and `answers` as `event` has them.
  [[nodiscard]] nlohmann::ordered_json history() const;
  /// Frames and answers from these numbers on, and what the next numbers are.
  [[nodiscard]] nlohmann::ordered_json event(std::uint64_t first_frame,
                                             std::uint64_t first_answer) const;
  [[nodiscard]] nlohmann::ordered_json loops(std::size_t first, std::size_t count) const;
  [[nodiscard]] nlohmann::ordered_json marks() const;
  /// `query,reference` of the loops that a person accepted, or `query,name` of marks.
  [[nodiscard]] std::string truth_csv() const;

  /// @return whether there is such a loop, and it is none with another robot
  [[nodiscard]] bool judge(std::size_t loop, Verdict verdict);
  /// Marks the newest frame. @return whether there was room
  [[nodiscard]] bool mark(std::string_view name);

  [[nodiscard]] const Snapshot& newest() const noexcept { return newest_; }
  [[nodiscard]] std::uint64_t frames_seen() const noexcept { return frames_seen_; }
  [[nodiscard]] std::uint64_t answers_seen() const noexcept { return answers_seen_; }
  [[nodiscard]] const std::optional<Answer>& last_answer() const noexcept { return last_answer_; }
  [[nodiscard]] std::size_t loop_count() const noexcept { return loop_list_.size(); }
  [[nodiscard]] nlohmann::ordered_json& run() noexcept { return run_; }
  [[nodiscard]] const std::vector<Loop>& loop_list() const noexcept { return loop_list_; }

 private:
  struct Shown {
    std::uint64_t number;  ///< of the answer: 0 for the first of all
    Answer answer;
  };
  void note_trouble(const Snapshot& snapshot);
  [[nodiscard]] nlohmann::ordered_json stages() const;
  [[nodiscard]] static nlohmann::ordered_json row(const Shown& shown);
  [[nodiscard]] double time_of(std::uint64_t frame) const;

  nlohmann::ordered_json run_;
  Snapshot newest_;
  std::array<LatencyHistogram, stage_names.size()> times_;
  std::deque<Snapshot> frames_;                           // newest ones
  std::deque<std::pair<std::uint64_t, double>> times_s_;  // of frames whose answers may still come
  std::uint64_t frames_seen_ = 0;
  std::vector<Shown> thinned_;
  std::uint64_t every_ = 1;
  std::deque<Shown> recent_;
  std::uint64_t answers_seen_ = 0;
  std::optional<Answer> last_answer_;
  std::optional<Answer> last_match_;
  std::vector<Loop> loop_list_;
  std::uint64_t loops_seen_ = 0;
  std::uint64_t loops_of_others_ = 0;
  std::vector<std::pair<std::string, std::string>> others_;  // robots and sessions of loops
  std::vector<Mark> marks_;
  std::deque<Trouble> troubles_;  // newest ones, the newest last
  std::optional<double> frame_at_s_;
  std::optional<double> over_since_s_;
};

}  // namespace seqloop::program
