// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_budget.hpp"
#include "seqloop/detail/candidate_proposals.hpp"
#include "seqloop/detail/candidate_ranges.hpp"
#include "seqloop/detail/change_degree.hpp"
#include "seqloop/detail/difference_slices.hpp"
#include "seqloop/detail/frame_steps.hpp"
#include "seqloop/detail/keyframes.hpp"
#include "seqloop/detail/loop_decision.hpp"
#include "seqloop/detail/pending_answers.hpp"
#include "seqloop/detail/place_belief.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/detail/running_statistics.hpp"
#include "seqloop/detail/sequence_search.hpp"
#include "seqloop/detail/sideways_shift.hpp"
#include "seqloop/detail/stop_frames.hpp"
#include "seqloop/detail/trajectories.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Answers, frame by frame, whether the robot has been here before. One step for all methods:
/// SeqCNNSLAM, A-SeqCNNSLAM and O-SeqCNNSLAM differ in which rows of the map are candidates,
/// SeqSLAM in how descriptors are compared and that differences are enhanced. Where A- and
/// O-SeqCNNSLAM relocalise, candidates come from the last frame's best rows and from a scan of a
/// part of the map, the best first, until the frame's budget of distances is spent: no frame's work
/// grows with the map.
///
/// Frames are of one camera, in the order in which they were taken: several cameras of a robot are
/// several detectors.
///
/// Threads: one at a time. Localising only reads the map, so that detectors in threads of their own
/// may share one that nobody changes.
class Detector {
 public:
  /// Bytes of every buffer beside the map's. Errors: SetupError, all faults at once.
  [[nodiscard]] static std::vector<BufferSize> plan(const MatcherConfig& config,
                                                    const Capacity& capacity);
  [[nodiscard]] static std::uint64_t bytes_needed(const MatcherConfig& config,
                                                  const Capacity& capacity) {
    return total_bytes(plan(config, capacity));
  }

  /// The most that one step can cost, but for what `take_in` leaves to it. Errors: those of `plan`.
  [[nodiscard]] static Work most_work(const MatcherConfig& config, const Capacity& capacity);

  /// @param map lives longer than the detector. To localise: filled (and standardised, where the
  ///   configuration standardises), and linked by a `VisitFinder` where it holds a drive that
  ///   passed places more than once. To close loops: empty, or filled with earlier sessions; the
  ///   drive becomes another one, to which the steps add: one such detector at a time has a map.
  /// @param memory [bytes_needed(config, map's capacity)] aligned to Arena::alignment; empty: own
  /// Errors: SetupError, all faults at once.
  Detector(const MatcherConfig& config, PlaceMap& map, std::span<std::byte> memory = {});

  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;
  Detector(Detector&&) = delete;
  Detector& operator=(Detector&&) = delete;
  ~Detector() = default;

  /// Values in a descriptor, D: those of the map.
  [[nodiscard]] std::size_t descriptor_size() const noexcept { return map_->descriptor_size(); }

  /// Takes the next frame, and answers each frame whose one final answer is due: as soon as it is
  /// sure, or `patience` frames later. By uniqueness that is the window's centre, the frame
  /// ds - ds/2 before this one.
  /// @param descriptor [D] unit L2 (squares that add up to .99 .. 1.01), or finite where the
  ///   difference is mean absolute. If it is empty, of another size, neither of these, or blank
  ///   where `blank_is_unreadable`, the frame could not be read: for sequences it counts as
  ///   one at which the scene stood still, and its answer is `frame_error`; by uniqueness, that of
  ///   the centre frame is.
  /// @note Where sequences are made of keyframes (`has_keyframes`), a frame that is none becomes no
  ///   place, moves nothing, unless the robot may drive on unseen, and is answered as the keyframe
  ///   before it.
  /// Work: at most `most_work`. Allocates: never.
  [[nodiscard]] FrameReport step(std::span<const float> descriptor) noexcept;

  /// Takes several frames of a recording: the same answers as by as many steps. Localising, where
  /// all rows are candidates, compared by `int8` or by Euclid's distances of floats, places are
  /// read once for all of these frames, which is several times faster.
  /// @param descriptors each as `step` takes it
  /// @param reports     written; their answers stand until the next step, or `finish`
  /// @return how many frames were taken, the first ones: all, or `MatcherConfig::frames_at_once`,
  ///   or as many as there are reports
  /// Work: as many steps. Allocates: never.
  [[nodiscard]] std::size_t steps(std::span<const std::span<const float>> descriptors,
                                  std::span<FrameReport> reports) noexcept;

  /// Takes note of frames that never came: the camera lost them, or they were dropped. Up to ds of
  /// them, in one call or several, are frames at which the scene stood still, so that trajectories
  /// keep their velocities; closing loops, they become places. Where the robot stood, or frames
  /// follow each other closely, the next one that can be read tells whether they are steps at all.
  /// With more, what was seen before says nothing of now: the window begins anew (`warming_up`),
  /// and of that call none is counted. None is before the first step, either. Work: N + D copies a
  /// frame at most, in this call or the next step; no distances, no line-sums. Allocates: never.
  /// Source: src/README.md, section 5.7.
  void skip(std::uint64_t frames) noexcept;

  /// Takes in a place that another robot has saved meanwhile, between two steps.
  /// @param session of the map; not the one that this detector adds to
  /// @return whether it has; not where `PlaceMap::add_saved_to` gives no row
  /// Work: as that, and what is remembered of rows; where all rows are candidates, the next step
  /// computes ds + 1 distances more. Allocates: never.
  bool take_in(std::size_t session, const PlaceMap::Saved& place) noexcept;

  /// Answers that are not given yet are accepted from this probability on, where the decision is by
  /// probability. @param min_probability above 0 .. 1
  /// @return false when it is not, as NaN is not: then nothing has changed. Allocates: never.
  bool accept_from(float min_probability) noexcept { return pending_.accept_from(min_probability); }

  /// The recording is over: answers every frame that still waits; by uniqueness none does. A live
  /// loop calls it when it ends; a step after it begins anew, as after many frames that never came.
  /// @return in order of frame; valid until the next step. Work: none to speak of.
  /// Allocates: never.
  [[nodiscard]] std::span<const Answer> finish() noexcept;

  /// By what the drive's frames are standardised now: what its session is saved with. A later drive
  /// starts from it if it is given to the map (`PlaceMap::set_statistics`), and anew otherwise.
  /// `frames() == 0` where nothing is.
  [[nodiscard]] const RunningStatistics& statistics() const noexcept { return statistics_; }

  /// From now on a full map may forget places, but none of the newest `places`, and none that come
  /// before this is called again: they are still needed elsewhere, or are to be saved first. As
  /// long as it is not called, any may go.
  void keep_newest(std::size_t places) noexcept { keep_ = std::min(places, map_->capacity()); }

  /// What is believed at the newest frame, and what for: where the decision is by probability.
  [[nodiscard]] const std::optional<Evidence>& evidence() const noexcept {
    return pending_.evidence();
  }

  /// About what the newest step compared: its descriptor, standardised if that is on.
  /// @param out [map.rows().restored_size()]; at least one step must have been made
  void newest_query(std::span<float> out) const noexcept {
    queries_.rows().restore(queries_.row_of(queries_.newest()), out);
  }

  /// The newest frame's column of the difference matrix.
  /// @param out [at most map.size()] below zero where nothing was computed (everywhere, where not
  ///   all rows are candidates, until a line needs it)
  void newest_column(std::span<float> out) const noexcept {
    slices_.show(*map_, queries_.newest(), out);
  }

 private:
  Detector(const MatcherConfig& config, PlaceMap& map, ArenaMemory&& memory);
  Detector(Arena arena, const MatcherConfig& config, PlaceMap* map, const Capacity& capacity,
           ArenaMemory&& memory);

  [[nodiscard]] FrameReport take(std::span<const float> descriptor) noexcept;
  [[nodiscard]] FrameReport answer(std::uint64_t newest, bool readable) noexcept;
  [[nodiscard]] FrameReport match_centre(std::uint64_t newest, bool readable) noexcept;
  void report_due(FrameReport& report, bool readable) noexcept;
  void say_now(FrameReport& report, bool repeats) noexcept;
  void say_last(FrameReport& report, std::uint64_t newest, bool readable) const noexcept;
  /// What became of a frame.
  struct Taken {
    bool readable;
    bool step;  ///< or it is the newest one
  };
  [[nodiscard]] Taken take_query(std::span<const float> descriptor) noexcept;
  [[nodiscard]] FrameReport report_again(bool readable) noexcept;
  /// Frames of which what comes next tells what they are.
  struct HeldBack {
    std::uint64_t frames = 0;
    std::uint64_t steps = 0;  ///< that they are if the next one shows something new
  };
  [[nodiscard]] bool may_be_no_steps() const noexcept;
  void hold_back(std::uint64_t frames, std::uint64_t steps) noexcept;
  void let_go(const HeldBack& held_back) noexcept;
  void pass(std::uint64_t steps, std::uint64_t frames) noexcept;
  [[nodiscard]] bool may_be_elsewhere(std::uint64_t step) const noexcept;
  void tell(const Answer& answer, std::uint64_t frame, bool settled) noexcept;
  void tell(FrameReport& report, std::span<const Answer> answers) noexcept;
  void stand(std::uint64_t frames) noexcept;
  [[nodiscard]] std::uint64_t steps_of(std::uint64_t frames) noexcept;
  [[nodiscard]] bool may_be_hidden() const noexcept;
  void lose_sight(bool is_step) noexcept;
  [[nodiscard]] std::size_t learn_shift() noexcept;
  [[nodiscard]] bool become_place() noexcept;
  void restart() noexcept;
  [[nodiscard]] std::size_t rows_searched(std::uint64_t centre) const noexcept;
  [[nodiscard]] std::size_t complete_rows() const noexcept;
  [[nodiscard]] std::size_t fill_columns(std::uint64_t newest) noexcept;
  [[nodiscard]] bool choose_candidates(std::uint64_t newest, std::size_t rows) noexcept;
  void expect_next(const BestRow& best, std::size_t rows, std::uint64_t newest) noexcept;
  [[nodiscard]] std::size_t ahead_of(std::size_t row, std::size_t line) const noexcept;
  [[nodiscard]] std::size_t ahead_of(const BestRow& best) const noexcept;
  void decide(FrameReport& report, const std::optional<BestRow>& best) const noexcept;

  ArenaMemory memory_;
  MatcherConfig config_;
  PlaceMap* map_;
  std::optional<std::size_t> keep_;  // newest places that somebody else needs; none: nobody does
  std::uint64_t window_began_ = 0;   // the first frame that is matched together with the newest
  Trajectories trajectories_;
  RunningStatistics statistics_;
  QueryHistory queries_;
  SidewaysShift shift_;
  DifferenceSlices slices_;
  SequenceSearch search_;
  CandidateRanges ranges_;
  CandidateProposals proposals_;
  CandidateBudget budget_;
  ChangeDegree change_degree_;
  LoopDecision decision_;
  PlaceBelief belief_;
  PendingAnswers pending_;
  Keyframes keyframes_;
  FrameSteps steps_;
  std::uint64_t skipped_ = 0;         // frames since the last that came
  bool newest_was_seen_ = false;      // the newest step is a frame that could be read
  HeldBack held_back_;                // since that step
  std::uint64_t unread_ = 0;          // frames in a row, up to the newest
  std::uint64_t unseen_ = 0;          // steps in a row that nothing was seen at
  FrameReport last_;                  // of that step
  std::optional<Answer> its_answer_;  // of that step, once it has been given
  std::span<Answer> told_;            // of frames, where not each is a step
  std::size_t told_count_ = 0;
  StopFrames answered_;            // what the frames were matched with that have been answered
  StopFrames believed_;            // what the newest frames are believed to be
  std::span<float> standardised_;  // [D]
};

}  // namespace seqloop
