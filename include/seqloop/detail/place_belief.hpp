// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/belief_traces.hpp"
#include "seqloop/detail/evidence.hpp"
#include "seqloop/detail/first_frames.hpp"
#include "seqloop/detail/scene.hpp"
#include "seqloop/detail/wrong_rows.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// Where the robot may be, and whether the map knows the place at all: a discrete Bayes filter over
/// a few rows and "somewhere new", fed by the sketches of each frame. How well a row has done is
/// compared with how well the best wrong rows do in this drive, which is learnt as it goes; a robot
/// that stands gains nothing. Source: src/README.md, section 6; Xu, Fischer, Suenderhauf, Milford
/// 2021.
class PlaceBelief {
 public:
  /// Rows that are weighed at a frame.
  static constexpr std::size_t most = 64;

  /// Pairs of sketches that one frame compares.
  static constexpr std::size_t most_sketches =
      (most_sketches_of_gain + sketches_of_in_step) * most + 1 + SceneGauge::most_sketches +
      FirstFrames::most_sketches;

  /// Frames before the newest one that are looked back on.
  static constexpr std::size_t reach = SceneGauge::reach;

  /// Frames of a trace that are kept: those that may wait, and never too few to judge a trace by.
  [[nodiscard]] static std::size_t depth(const MatcherConfig& config) noexcept {
    constexpr std::size_t least = 30;
    return config.decision == Decision::probability ? std::max(config.patience, least) + 1 : 0;
  }

  /// Allocates: from the arena only.
  PlaceBelief(Arena& arena, const MatcherConfig& config);

  /// Takes the newest frame. @param jumps the chance that the robot was carried away with it and is
  /// on the map again: `PendingAnswers::chance_of_return`
  /// @return pairs of sketches compared
  /// Work: `most_sketches`, and two exponentials for each hypothesis. Allocates: never.
  std::size_t observe(const SceneView& view, double jumps) noexcept;

  /// Takes in where the newest window's best line leads: it is born there with the next frame, if
  /// the line stands out. @param uniqueness as `Match` has it; NaN: nothing is known of it
  void expect(std::size_t row, double uniqueness) noexcept;

  /// Frames went by unseen, and the robot moved on by this many rows in each.
  void pass(const PlaceOrder& order, std::uint64_t frames, std::size_t rows) noexcept;

  /// A frame shows nothing, and the robot may stand or drive on meanwhile.
  /// @param is_step whether it is a step of its own; otherwise it is one with the newest
  /// Work: three moves of each row that is weighed. Allocates: never.
  void drift(const PlaceMap& map, bool is_step) noexcept;

  /// A row went from the map: those behind it are counted one lower. @param forgotten as
  /// `PlaceMap::Taken` has it
  void removed(std::size_t row, bool forgotten) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

  /// Another robot has saved a place meanwhile. Where this one localises, no belief comes from now
  /// on into a map of fewer than 100 rows; what has come stays. @param capacity of the map, where
  /// that is less
  void taken_in(std::size_t capacity) noexcept;

  /// Nothing is known of where the robot is; what was learnt of the drive stays.
  void restart() noexcept;

  /// Whether a map holds other drives than the one that is being driven, and enough of them to be
  /// believed.
  [[nodiscard]] static bool has_earlier_drives(bool localises, const PlaceOrder& order) noexcept {
    return localises || order.newest_session().first >= SceneGauge::least_rows;
  }

  /// A row of the newest frame and what speaks for it.
  struct Likeliest {
    std::size_t row;
    std::size_t index;  ///< for `trace`
    Evidence evidence;
  };
  [[nodiscard]] const std::optional<Likeliest>& likeliest() const noexcept { return likeliest_; }

  /// Remembers the log-odds of the likeliest row. @return the best on the way there. In a drive
  /// that closes loops the best of all rows starts anew where the newest frames raise much doubt:
  /// the robot has left the road that it came along, and what was known there says nothing of the
  /// next.
  double remember(double odds) noexcept;

  /// That the robot is somewhere new, 0 .. 1.
  [[nodiscard]] double new_place() const noexcept { return new_place_; }

  /// Whether a row is one place with the likeliest one of its session. Work: its hypotheses.
  [[nodiscard]] bool is_likeliest_of_session(const PlaceMap& map, std::size_t row) const noexcept;

  /// The way that a row was come by: see `BeliefTraces`.
  std::size_t trace(std::size_t index, std::span<BeliefTraces::Step> out) const noexcept {
    return traces_.trace(index, out);
  }

  /// Follows a trace that began among the drive's first frames back to its first one: as
  /// `FirstFrames` does.
  std::size_t follow_back(const PlaceMap& map, std::span<BeliefTraces::Step> trace,
                          std::size_t count, std::uint64_t newest,
                          std::size_t& sketches) const noexcept {
    return first_frames_.follow(map, trace, count, newest, sketches);
  }

  /// What the best wrong rows gain, by novelty; 0 or more.
  [[nodiscard]] double usual_gain() const noexcept;

  /// The newest frame's novelty, 0 .. 1, where something is believed of it.
  [[nodiscard]] double newest_novelty() const noexcept { return newest_novelty_; }

  /// The novelty that a frame of this drive has, 0 .. 1.
  [[nodiscard]] double usual_novelty() const noexcept { return wrong_.novelty(); }

 private:
  struct Hypothesis {
    std::size_t row = 0;
    double mass = 0.0;      // belief
    double told = 0.0;      // what the newest frame said for it
    double gain = 0.0;      // decaying sum of that
    double wrong = 0.0;     // the same of the frames at which it was wrong
    double usual = 2.0;     // decaying mean of what frames said, by novelty
    double past = -10.0;    // best log-odds on the way
    double contrast = 0.0;  // decaying mean
    double alike = 0.0;     // likewise, of `Scene::alike`
    double step = 0.0;      // the newest `in_step`; NaN: nothing is known
    double in_step = 0.0;   // decaying mean of those that are known
    double age = 0.0;       // novel frames
    double doubt = 0.0;     // as `Evidence` has it
    double pace = 1.0;      // decaying mean of the rows that it went on by, 0 .. 2
    bool shown = false;     // the newest frame by itself shows the place
    BeliefTraces::Index parent = BeliefTraces::none;
  };

  /// A hypothesis on its way to the next frame.
  struct Moved {
    std::size_t row;
    double mass;
    double share;  // of what it has gained that stays
    BeliefTraces::Index parent;
  };

  /// What a frame by itself shows best.
  struct Shown {
    std::size_t row;
    double least;  // gain without bounds of rows of its place that the frame by itself shows
  };

  /// What has gone beyond the rows of its session.
  struct Ended {
    double mass = 0.0;
    double most = 0.0;     // of it, with one move of one hypothesis
    std::size_t from = 0;  // this one
  };

  static void prefetch(const SceneView& view) noexcept;
  [[nodiscard]] Moves moves_of(const PlaceOrder& order, const Hypothesis& at, const Scene& scene,
                               double jumps) const noexcept;
  [[nodiscard]] double pace_after(const Hypothesis& at, double by) const noexcept;
  [[nodiscard]] static Moves unseen_moves_of(const PlaceOrder& order,
                                             const Hypothesis& at) noexcept;
  void move(const PlaceOrder& order, std::span<const Moves> moves, double least) noexcept;
  void keep_likeliest() noexcept;
  void leave(double share) noexcept;
  void give_birth(const SceneView& view, double mass) noexcept;
  void bear(std::size_t row, double mass) noexcept;
  void hand_over(const PlaceMap& map) noexcept;
  void take_on(const PlaceOrder& order, Hypothesis& at, const Moved& moved,
               bool drives) const noexcept;
  [[nodiscard]] std::optional<std::size_t> came_from(const PlaceOrder& order,
                                                     const Hypothesis& at) const noexcept;
  void weigh(const SceneView& view, const Scene& scene) noexcept;
  [[nodiscard]] Shown shown_best(const PlaceMap& map, std::span<const double> gains) const noexcept;
  void normalise() noexcept;
  void sharpen(const PlaceOrder& order, const Scene& scene, std::span<const double> gains) noexcept;
  [[nodiscard]] std::span<Hypothesis> of_session(const PlaceOrder& order,
                                                 std::size_t row) const noexcept;
  /// Whether "somewhere new" has no more than half of the belief.
  [[nodiscard]] bool is_on_map() const noexcept { return new_place_ <= 0.5; }
  void judge(const SceneView& view, const Scene& scene, double jumps) noexcept;
  void share_history(const PlaceOrder& order, const Hypothesis& top, Hypothesis& at) noexcept;
  [[nodiscard]] bool is_of_this_drive(const PlaceOrder& order, std::size_t row) const noexcept;
  [[nodiscard]] double unlike(const PlaceMap& map, const Hypothesis& at) const noexcept;
  void know_better(const PlaceMap& map, std::size_t index) noexcept;

  bool localises_;
  std::size_t sketches_ = 0;
  std::size_t weighed_ = 0;     // frames since nothing was known
  std::size_t least_rows_ = 0;  // below which no belief comes
  double new_place_ = 1.0;
  WrongRows wrong_;  // what the best wrong rows gain
  std::size_t count_ = 0;
  double newest_novelty_ = 0.0;
  std::size_t moved_count_ = 0;
  Ended ended_;
  std::optional<Likeliest> likeliest_;
  std::optional<std::size_t> expected_;  // row of the next frame, by the best line before it
  std::span<Hypothesis> rows_;           // [most] in order of row
  std::span<Hypothesis> next_;           // [most] of the frame that is being weighed
  std::span<Moved> moved_;               // [3 most]
  SceneGauge gauge_;
  FirstFrames first_frames_;
  BeliefTraces traces_;
};

}  // namespace seqloop
