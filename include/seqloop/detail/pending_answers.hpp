// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/accepted_frames.hpp"
#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/frame_steps.hpp"
#include "seqloop/detail/jump_rate.hpp"
#include "seqloop/detail/kept_row.hpp"
#include "seqloop/detail/place_belief.hpp"
#include "seqloop/detail/trace_span.hpp"
#include "seqloop/detail/trajectories.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// A line that sequence search found for a frame.
struct FoundLine {
  std::size_t row;    ///< at the frame's column
  double score;       ///< mean difference along it
  double uniqueness;  ///< as `Match` has it
  std::size_t line;
  bool may_be_here = false;  ///< it leads to the likeliest row of its session
};

/// Frames that wait for their one final answer: until the evidence suffices, or as many frames have
/// come after them as patience allows. The belief says whether, sequence search where.
class PendingAnswers {
 public:
  /// Lines that are kept of a frame.
  static constexpr std::size_t lines_kept = 4;

  /// As much is told at most where only that is in doubt on which side of a jump a frame lies.
  static constexpr double most_in_doubt = 0.95;

  /// Allocates: from the arena only.
  PendingAnswers(Arena& arena, const MatcherConfig& config, const Trajectories& trajectories);

  /// From here on answers are accepted from this probability on. @param least above 0 .. 1
  /// @return false when it is not: then nothing has changed
  bool accept_from(float least) noexcept;

  /// Whether an answer of this probability is accepted.
  [[nodiscard]] bool accepts(float probability) const noexcept {
    return static_cast<double>(probability) >= least_;
  }

  /// The newest frame is not, or no longer, what was judged.
  void forget_evidence() noexcept { evidence_.reset(); }

  /// Another frame waits. @param readable whether it could be read
  /// @param moved to the side, as `SidewaysShift` says
  void add(std::uint64_t frame, bool readable, int moved = 0) noexcept;

  /// What sequence search found for a frame, best first; at most `lines_kept`.
  void found(std::uint64_t frame, std::span<const FoundLine> lines) noexcept;

  /// Takes in what is believed at the newest frame.
  /// @param oldest frame that belongs together with it
  /// @return pairs of sketches compared
  /// Work: a pass over the frames that wait, as many exponentials as patience has frames, twice
  /// where loops are closed or the robot has been carried away, and that of `FirstFrames::follow`.
  /// Allocates: never.
  std::size_t believe(PlaceBelief& belief, const PlaceMap& map, std::uint64_t newest,
                      std::uint64_t oldest) noexcept;

  /// What speaks for the likeliest row of the newest frame; none: nothing is known of any, or the
  /// frame could not be read.
  [[nodiscard]] const std::optional<Evidence>& evidence() const noexcept { return evidence_; }

  /// The chance that the robot is carried away with a frame, beyond what is usual.
  [[nodiscard]] double jumps() const noexcept { return jump_rate_.chance(); }

  /// How lately the robot was found: 1 up to 100 frames after the newest frame whose answer was
  /// accepted, 0 from 200 on, and where there is none since a gap or in this drive.
  /// @param frame the newest, or a later one
  [[nodiscard]] double found_lately(std::uint64_t frame) const noexcept;

  /// Whether the way from where the robot was found last leads to a row: by a row a frame, six rows
  /// and a quarter of the frames more or fewer, not beyond the session's end. Not where it never
  /// was found. @param frame as above
  [[nodiscard]] bool leads_to(const PlaceOrder& order, std::uint64_t frame,
                              std::size_t row) const noexcept;

  /// How much of the chance of a jump says that the robot will be found on the map again: all of it
  /// up to 50 frames after it was, nothing from 100 on. @param frame as above
  [[nodiscard]] double chance_of_return(std::uint64_t frame) const noexcept;

  /// Frames are missing, nobody knows how many: nothing was found lately, or is judged.
  void forget_what_was_found() noexcept;

  /// What comes is another drive: a robot that was carried about in this one, or saw little of its
  /// places, may not in that.
  void forget_drive() noexcept {
    jump_rate_ = {};
    accepted_ = {};
  }

  /// Writes the answers that are due, in order of frame, behind those that are there. A frame that
  /// is a place, and is likely another one too, is linked to that.
  /// @param oldest frame that belongs together with the newest: those before it wait no longer
  void answer(PlaceMap& map, const FrameSteps& steps, std::uint64_t newest,
              std::uint64_t oldest) noexcept;

  /// Whether a frame by itself shows the place where it is believed to have been taken, and no
  /// other place as well; false where nothing is known.
  [[nodiscard]] bool shows_its_place(std::uint64_t frame) const noexcept {
    const Waiting& waiting = waiting_[slot_of(frame)];
    return waiting.frame == frame && waiting.shown;
  }

  /// Takes an answer that did not wait.
  void say(const Answer& answer) noexcept { answers_[given_++] = answer; }

  [[nodiscard]] std::span<const Answer> answers() const noexcept { return answers_.first(given_); }

  /// The answers so far have been handed over.
  void clear() noexcept { given_ = 0; }

  /// A row went from the map: those behind it are counted one lower. A frame that waits, and was at
  /// a place that is forgotten, is answered as if nothing were known of it.
  /// @param forgotten as `PlaceMap::Taken` has it
  void removed(std::size_t row, bool forgotten) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

 private:
  /// How much better one line is than another.
  struct Lead {
    double here;
    double elsewhere;
    double log_ratio;
  };
  struct Waiting {
    std::uint64_t frame = 0;
    bool waits = false;
    bool readable = false;
    int moved = 0;            // to the side
    bool believed = false;    // whether it lies on a trace
    bool left = false;        // by the trace of the newest frame that was looked back from
    std::size_t row = 0;      // there
    double right = 0.0;       // that the trace is right: the most that was ever said
    double same_place = 0.0;  // the same, with nothing asked besides
    TraceSpan::On on{};       // that the frame lies on it
    TraceSpan::On carried{};  // the same, if the robot is carried away as often as it was
    std::uint64_t lag = 0;    // frames that had come after it when it was looked back on last
    double new_place = 1.0;   // belief in none, as it came
    std::size_t likeliest = gone<std::size_t>;  // row, as it came; `none` where there was none
    double doubt = 0.0;                         // whether the robot was still there, as it came
    bool doubted = false;                       // it has risen too much since
    bool shown = false;                         // whether it by itself shows the row
    double gain = 0.0;                          // there, as `BeliefTraces::Step` has it
    double novelty = 0.0;                       // as it came
    std::size_t lines = 0;                      // found
    Lead lead{};                                // that `margin` took the logarithm of last
  };

  /// What a trace that came through a frame says of it.
  struct LookedBack {
    double right;           // that the trace is right
    double same_place;      // as `Waiting` has it
    TraceSpan::On on;       // that the frame lies on it
    TraceSpan::On carried;  // as `Waiting` has it
    std::uint64_t lag;      // frames that have come since
  };

  /// A power of two, so that nothing is divided: a step asks for this many hundred times.
  [[nodiscard]] std::size_t slot_of(std::uint64_t frame) const noexcept {
    return static_cast<std::size_t>(frame) & (waiting_.size() - 1);
  }
  [[nodiscard]] Waiting& at(std::uint64_t frame) noexcept { return waiting_[slot_of(frame)]; }
  [[nodiscard]] std::span<FoundLine> lines_in(std::size_t slot) noexcept {
    return lines_.subspan(slot * lines_kept, lines_kept);
  }
  [[nodiscard]] double found_within(std::uint64_t frame, double frames) const noexcept;
  [[nodiscard]] bool may_be_beyond_the_end(
      const PlaceMap& map, std::uint64_t newest,
      std::span<const BeliefTraces::Step> trace) const noexcept;
  [[nodiscard]] double asked_of(const PlaceMap& map, std::uint64_t newest,
                                std::span<const BeliefTraces::Step> trace) noexcept;
  [[nodiscard]] static double probability(const Waiting& waiting) noexcept;
  [[nodiscard]] bool is_sure(const PlaceMap& map, const Waiting& waiting) noexcept;
  [[nodiscard]] bool is_beside_a_jump(const PlaceMap& map, const Waiting& waiting) noexcept;
  [[nodiscard]] bool is_borne_out(const PlaceMap& map, const Waiting& waiting) noexcept;
  [[nodiscard]] double told(const PlaceMap& map, const Waiting& waiting) noexcept;
  [[nodiscard]] bool knows_another_session(const PlaceMap& map, const Waiting& waiting,
                                           std::size_t row) noexcept;
  [[nodiscard]] bool hops(const PlaceMap& map, const Waiting& waiting) noexcept;
  [[nodiscard]] double margin(const PlaceMap& map, std::size_t slot, std::size_t row) noexcept;
  void look_at_windows(const PlaceMap& map, std::uint64_t newest,
                       std::span<BeliefTraces::Step> trace) noexcept;
  void note_moves(std::uint64_t newest, std::span<BeliefTraces::Step> trace) noexcept;
  void ask_belief(const PlaceMap& map, std::uint64_t newest,
                  std::span<BeliefTraces::Step> trace) noexcept;
  void ask_steps(std::span<BeliefTraces::Step> trace) const noexcept;
  void keep_in_doubt(std::uint64_t newest) noexcept;
  void look_back(const PlaceOrder& order, Waiting& waiting, const BeliefTraces::Step& step,
                 const LookedBack& back) noexcept;
  [[nodiscard]] std::optional<FoundLine> line_near(const PlaceMap& map,
                                                   std::uint64_t frame) noexcept;
  [[nodiscard]] bool lies_on_trace(const PlaceOrder& order, std::uint64_t frame) noexcept;
  [[nodiscard]] bool has_all(const PlaceMap& map, const FoundLine& line) const noexcept;
  [[nodiscard]] Match match(const PlaceMap& map, std::uint64_t frame) noexcept;
  [[nodiscard]] bool may_be_new(const PlaceMap& map, std::uint64_t began) const noexcept;
  void give(PlaceMap& map, const FrameSteps& steps, Waiting& waiting, bool may_be_new) noexcept;
  void link(PlaceMap& map, const FrameSteps& steps, Waiting waiting) noexcept;

  const Trajectories* trajectories_;
  std::size_t patience_;
  std::size_t after_centre_;
  bool grows_;
  double least_;
  double least_before_calibration_;
  std::uint64_t first_ = 0;  // frame that may still wait
  std::uint64_t end_ = 0;    // after the newest
  std::size_t given_ = 0;
  std::optional<Evidence> evidence_;
  std::span<Waiting> waiting_;           // [depth + ds + 1 or more], a ring by frame
  std::span<FoundLine> lines_;           // [the same, lines_kept]
  std::span<Answer> answers_;            // [patience + frames at once + 1]
  std::span<BeliefTraces::Step> trace_;  // [PlaceBelief::depth]
  std::span<TraceSpan::On> carried_;     // [the same]
  TraceSpan span_;
  JumpRate jump_rate_;
  AcceptedFrames accepted_;
  // By the newest frame whose answer was accepted; row `none`: it has gone.
  std::optional<JumpRate::Found> last_found_;
  std::uint64_t oldest_before_ = 0;  // frame that belonged together with the newest a step ago
};

}  // namespace seqloop
