// SPDX-License-Identifier: MIT
#include "seqloop/detail/pending_answers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "seqloop/detail/calibration.hpp"
#include "seqloop/detail/kept_row.hpp"
#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr float undefined_float = std::numeric_limits<float>::quiet_NaN();

constexpr std::size_t none = gone<std::size_t>;

// A line is a trace's own if it lies so near it.
constexpr std::size_t own = 6;

// So many frames either side of where two traces meet are in doubt: which of the two a frame there
// was on is known less well than that both are right.
constexpr std::uint64_t frames_at_a_meeting = 2;

// The margin that windows on a trace usually have.
constexpr double usual_margin = 0.04;

// Doubt that right rows have now and then.
constexpr double little_doubt = 0.5;

/// That a trace is right whose best log-odds, of all frames that were looked back from, are these:
/// the best of many are higher than those of one, wrong traces' most of all. Source: src/README.md,
/// section 6.6.
double trace_is_right(double best) {
  return logistic(std::min(1.5 * best - 0.6, 2.75 * best - 5.05));
}

/// Counts what is known of frames beyond what is asked of them for the trace; what is less, against
/// it.
/// @param known of a frame; NaN: nothing
void count_besides(std::span<BeliefTraces::Step> trace, double BeliefTraces::Step::*known,
                   double weight, double least) {
  for (BeliefTraces::Step& step : trace) {
    const double value = step.*known;
    if (!std::isnan(value)) step.besides += weight * step.novelty * (value - least);
  }
}

}  // namespace

PendingAnswers::PendingAnswers(Arena& arena, const MatcherConfig& config,
                               const Trajectories& trajectories)
    : trajectories_(&trajectories),
      patience_(config.patience),
      after_centre_(config.sequence_length - config.sequence_length / 2),
      grows_(config.use == Use::close_loops),
      span_(arena, config.use, PlaceBelief::depth(config)) {
  accept_from(config.min_probability);
  const bool used = config.decision == Decision::probability;
  const std::size_t kept = std::bit_ceil(PlaceBelief::depth(config) + config.sequence_length + 1);
  waiting_ = arena.take<Waiting>("frames that wait for their answer", used ? kept : 0);
  lines_ = arena.take<FoundLine>("lines found for them", used ? kept * lines_kept : 0);
  answers_ = arena.take<Answer>(
      "answers", used ? config.patience + config.frames_at_once + 1 : config.frames_at_once);
  trace_ = arena.take<BeliefTraces::Step>("the likeliest trace", PlaceBelief::depth(config));
  carried_ = arena.take<TraceSpan::On>("frames on it, where robots are carried away",
                                       grows_ ? 0 : PlaceBelief::depth(config));
}

bool PendingAnswers::accept_from(float least) noexcept {
  if (!(least > 0.0F && least <= 1.0F)) return false;
  least_ = static_cast<double>(least);
  least_before_calibration_ = before_calibration(least_);
  return true;
}

void PendingAnswers::add(std::uint64_t frame, bool readable, int moved) noexcept {
  forget_evidence();
  at(frame) = {.frame = frame, .waits = true, .readable = readable, .moved = moved};
  end_ = frame + 1;
}

void PendingAnswers::found(std::uint64_t frame, std::span<const FoundLine> lines) noexcept {
  if (at(frame).frame != frame) return;
  at(frame).lines = lines.size();
  std::ranges::copy(lines, lines_in(slot_of(frame)).begin());
}

void PendingAnswers::forget_what_was_found() noexcept {
  forget_evidence();
  last_found_.reset();
}

/// Linear between: the robot may not be where the map is any more.
double PendingAnswers::found_lately(std::uint64_t frame) const noexcept {
  return found_within(frame, 100.0);
}

/// One that comes back when it is carried about comes back soon.
double PendingAnswers::chance_of_return(std::uint64_t frame) const noexcept {
  return jumps() * found_within(frame, 50.0);
}

/// 1 up to so many frames after the robot was found, 0 from twice as many on.
double PendingAnswers::found_within(std::uint64_t frame, double frames) const noexcept {
  if (!last_found_) return 0.0;
  const auto since = static_cast<double>(frame - last_found_->frame);
  return std::clamp(2.0 - since / frames, 0.0, 1.0);
}

bool PendingAnswers::leads_to(const PlaceOrder& order, std::uint64_t frame,
                              std::size_t row) const noexcept {
  if (!last_found_ || last_found_->row == none) return false;
  const auto since = static_cast<std::size_t>(frame - last_found_->frame);
  const std::size_t there = last_found_->row + since;  // beyond the session's end there is no way
  const CandidateRun session = order.around(last_found_->row);
  return row >= session.first && row < session.last &&
         std::max(row, there) - std::min(row, there) <= own + since / 4;
}

/// That the robot was at the frame's row when it took it.
double PendingAnswers::probability(const Waiting& waiting) noexcept {
  return waiting.right * waiting.on.where(waiting.left);
}

/// Whether the robot may have driven out of an earlier drive where that ends, before a trace began
/// that does not go on from where it was last found.
bool PendingAnswers::may_be_beyond_the_end(
    const PlaceMap& map, std::uint64_t newest,
    std::span<const BeliefTraces::Step> trace) const noexcept {
  constexpr std::size_t off = 5;  // rows that it may be further on
  if (!last_found_ || last_found_->row == none) return false;
  const std::size_t from = last_found_->row;
  const CandidateRun session = map.order().around(from);
  if (grows_ && session.first == map.order().newest_session().first) return false;
  const std::uint64_t since = newest - last_found_->frame;
  const auto back = static_cast<std::size_t>(std::min<std::uint64_t>(since, trace.size() - 1));
  const std::size_t by = static_cast<std::size_t>(since) - back;
  const std::size_t row = trace[back].row;
  if (from + by + off < session.last) return false;
  const bool goes_on = row + own >= from && row >= session.first && row < session.last;
  return !goes_on && !map.same_place(from, row) &&
         !map.same_place(std::min(from + by, session.last - 1), row);
}

/// How much more the log-odds of the newest frame's row have to be, since much looks alike. Where
/// it is of this drive: many drives never come back to where they were; one that has will again,
/// but most of its frames are of new places. Where it is another drive's, and the robot was not
/// found lately, or may have driven on beyond that drive's end: it may be where nobody has driven
/// before.
double PendingAnswers::asked_of(const PlaceMap& map, std::uint64_t newest,
                                std::span<const BeliefTraces::Step> trace) noexcept {
  constexpr double of_a_first_loop = 2.2;
  constexpr double of_other_loops = 0.9;
  constexpr double of_other_drives = 0.5;
  const bool of_this_drive = grows_ && at(newest).likeliest >= map.order().newest_session().first;
  if (of_this_drive) return last_found_ ? of_other_loops : of_a_first_loop;
  const double lately = found_lately(newest);
  const double asked = of_other_drives * (1.0 - lately);
  if (!may_be_beyond_the_end(map, newest, trace)) return asked;
  // One that is carried about comes to other rows anyway.
  return asked + of_a_first_loop * lately * (1.0 - std::min(1.0, 10.0 * jump_rate_.chance()));
}

std::size_t PendingAnswers::believe(PlaceBelief& belief, const PlaceMap& map, std::uint64_t newest,
                                    std::uint64_t oldest) noexcept {
  const auto& likeliest = belief.likeliest();
  at(newest).new_place = belief.new_place();
  if (!likeliest) return 0;
  evidence_ = likeliest->evidence;
  const std::size_t born = belief.trace(likeliest->index, trace_);
  std::size_t sketches = 0;
  const auto trace = trace_.first(belief.follow_back(map, trace_, born, newest, sketches));
  at(newest).likeliest = trace.front().row;
  look_at_windows(map, newest, trace);
  const double best = belief.remember(log_odds(*evidence_));
  evidence_->asked = asked_of(map, newest, trace);
  const double right = trace_is_right(best - evidence_->asked);
  const double same_place = trace_is_right(best);
  for (std::uint64_t frame = std::max(first_, oldest); frame <= newest; ++frame) {
    at(frame).left = true;
  }
  keep_in_doubt(newest);
  const std::uint64_t first = newest - (trace.size() - 1);
  const Waiting& before = at(first);
  const bool known = before.frame == first && before.believed && before.lag > 0 &&
                     map.order().apart(before.row, trace.back().row) <= own;
  const auto waiting = static_cast<std::size_t>(newest + 1 - first_);
  const std::size_t frames = std::min(trace.size(), waiting);
  const double usual = belief.usual_gain();
  const double novelty = belief.usual_novelty();
  // Where a robot that was never carried away is surer than it has to be, no more is asked of a
  // frame than a part of what those show that were accepted.
  constexpr double much = 5.0;
  const double jumps = jump_rate_.chance();
  const bool sure = best - evidence_->asked >= much && jumps <= 0.0;
  ask_belief(map, newest, trace);
  const AcceptedFrames::Asked all{usual, usual_margin};
  const AcceptedFrames::Asked asked = sure ? accepted_.asked(all) : all;
  constexpr double of_windows = 16.0;
  count_besides(trace, &BeliefTraces::Step::margin, of_windows, asked.margin);
  ask_steps(trace);
  note_moves(newest, trace);
  span_.ask(trace, asked.gain);
  const double was_on = known ? before.right * before.on.still : 0.0;
  std::span<const TraceSpan::On> carried;
  if (jumps > 0.0) {
    std::ranges::copy(span_.find(trace, was_on, usual, novelty, jumps, frames), carried_.begin());
    carried = carried_.first(frames);
  }
  const auto on = span_.find(trace, was_on, usual, novelty, 0.0, frames);
  for (std::size_t back = 0; back < frames; ++back) {
    Waiting& frame = at(newest - back);
    if (!frame.waits || frame.frame != newest - back) continue;
    look_back(map.order(), frame, trace[back],
              {right, same_place, on[back], carried.empty() ? on[back] : carried[back], back});
  }
  return sketches;
}

/// By how much the frames of a trace were moved to the side; those that are not known as those
/// after them.
void PendingAnswers::note_moves(std::uint64_t newest,
                                std::span<BeliefTraces::Step> trace) noexcept {
  int moved = 0;
  for (std::size_t back = 0; back < trace.size(); ++back) {
    const Waiting& then = at(newest - back);
    if (then.frame == newest - back) moved = then.moved;
    trace[back].moved = moved;
  }
}

/// Whether the belief of the time was elsewhere than on a trace, or somewhere new.
void PendingAnswers::ask_belief(const PlaceMap& map, std::uint64_t newest,
                                std::span<BeliefTraces::Step> trace) noexcept {
  if (!grows_) return;
  constexpr double half = 0.5;
  for (std::size_t back = 0; back < trace.size(); ++back) {
    const Waiting& then = at(newest - back);
    if (then.frame != newest - back || then.likeliest == none) continue;
    trace[back].elsewhere =
        then.new_place > half || (map.order().apart(then.likeliest, trace[back].row) > own &&
                                  !map.same_place(then.likeliest, trace[back].row));
  }
}

/// Whether a trace changes as the frames do: a road beside it may look much like it, but changes in
/// its own way. Where little of a place is to be seen, all of the trace changes less than others
/// do.
void PendingAnswers::ask_steps(std::span<BeliefTraces::Step> trace) const noexcept {
  if (!grows_) return;
  constexpr double weight = 6.0;
  constexpr double most = 0.06;
  constexpr double share = 0.8;
  double sum = 0.0;
  double novelty = 0.0;
  for (const BeliefTraces::Step& step : trace) {
    if (std::isnan(step.in_step)) continue;
    sum += step.novelty * step.in_step;
    novelty += step.novelty;
  }
  if (novelty <= 0.0) return;
  const double usual = std::min(most, share * sum / novelty);
  count_besides(trace, &BeliefTraces::Step::in_step, weight, usual);
}

/// A trace that closes loops tells no end, but the doubt about the row that it leads on to does.
/// Once that has risen by so much, the robot may have left since: those frames are in doubt, until
/// hardly anything speaks against a trace that comes through them.
void PendingAnswers::keep_in_doubt(std::uint64_t newest) noexcept {
  constexpr double much = 5.0;
  constexpr double risen = 3.0;
  const double doubt = evidence_->doubt;
  at(newest).doubt = doubt;
  if (!grows_ || doubt <= much) return;
  double lowest = doubt;
  std::uint64_t first = newest + 1;
  for (; first > first_ && at(first - 1).frame == first - 1; --first) {
    const double then = at(first - 1).doubt;
    if (then < little_doubt || then > lowest + risen) break;  // it has fallen since
    lowest = std::min(lowest, then);
  }
  if (doubt - lowest <= risen) return;
  for (std::uint64_t frame = first; frame <= newest; ++frame) at(frame).doubted = true;
}

/// Takes in that a trace has come through a frame.
void PendingAnswers::look_back(const PlaceOrder& order, Waiting& waiting,
                               const BeliefTraces::Step& step, const LookedBack& back) noexcept {
  const auto& [right, same_place, on, carried, lag] = back;
  const bool same = waiting.believed && order.apart(waiting.row, step.row) <= own;
  if (waiting.believed && !same) {
    // One of the two is wrong.
    const double now = right * on.still;
    if (probability(waiting) > now) {
      for (TraceSpan::On* const its : {&waiting.on, &waiting.carried}) {
        *its = {std::min(its->still, 1.0 - now), std::min(its->left, 1.0 - now)};
      }
      return;
    }
  }
  waiting.right = same ? std::max(waiting.right, right) : right;
  waiting.same_place = same ? std::max(waiting.same_place, same_place) : same_place;
  waiting.on = on;
  waiting.carried = carried;
  waiting.lag = lag;
  waiting.row = step.row;
  waiting.shown = step.shown;
  waiting.gain = step.gain;
  waiting.novelty = step.novelty;
  waiting.left = false;
  waiting.believed = true;
  if (evidence_->doubt < little_doubt) waiting.doubted = false;
}

/// How much better the best line through a frame's row is than the best one elsewhere. Another
/// session may know the place, too: a line to its likeliest row is none elsewhere.
double PendingAnswers::margin(const PlaceMap& map, std::size_t slot, std::size_t row) noexcept {
  std::optional<double> here;
  std::optional<double> elsewhere;
  const PlaceOrder& order = map.order();
  for (const FoundLine& line : lines_in(slot).first(waiting_[slot].lines)) {
    const bool there = line.row < map.size();
    const bool same = there && map.same_place(line.row, row);
    if (there && !same && line.may_be_here &&
        order.around(line.row).first != order.around(row).first) {
      continue;
    }
    std::optional<double>& lowest = same ? here : elsewhere;
    if (!lowest) lowest = line.score;
    if (here && elsewhere) break;
  }
  constexpr double most = 0.2;
  if (!here) return -most;
  if (!elsewhere) return most;
  // A score of 0 has no logarithm: nothing can be seen better than to the bit.
  if (*here == 0.0) return *elsewhere == 0.0 ? 0.0 : most;
  if (*elsewhere == 0.0) return -most;
  // From step to step it is nearly always the same two lines.
  Lead& lead = waiting_[slot].lead;
  if (lead.here != *here || lead.elsewhere != *elsewhere) {
    lead = {*here, *elsewhere, logarithm(*elsewhere / *here)};
  }
  return std::clamp(lead.log_ratio, -most, most);
}

/// What sequence search says of the frames along the trace.
void PendingAnswers::look_at_windows(const PlaceMap& map, std::uint64_t newest,
                                     std::span<BeliefTraces::Step> trace) noexcept {
  constexpr std::size_t windows = 10;
  std::size_t asked = 0;
  for (std::size_t back = after_centre_; back < trace.size(); ++back) {
    const std::uint64_t frame = newest - back;
    const std::size_t slot = slot_of(frame);
    if (waiting_[slot].frame != frame || waiting_[slot].lines == 0) continue;
    trace[back].margin = margin(map, slot, trace[back].row);
    if (asked++ < windows) evidence_->margin += trace[back].margin / static_cast<double>(windows);
  }
}

void PendingAnswers::answer(PlaceMap& map, const FrameSteps& steps, std::uint64_t newest,
                            std::uint64_t oldest) noexcept {
  for (std::uint64_t frame = first_; frame < end_; ++frame) {
    Waiting& waiting = at(frame);
    if (!waiting.waits || waiting.frame != frame) continue;
    const bool late = frame < oldest || newest - steps.frame_of(frame) >= patience_;
    if (!late && !is_sure(map, waiting) && waiting.readable) continue;
    const std::uint64_t began = frame < oldest ? oldest_before_ : oldest;
    give(map, steps, waiting, may_be_new(map, began));
    if (answers_[given_ - 1].gate != Gate::match) continue;
    if (waiting.lines > 0) {
      accepted_.take(waiting.gain, waiting.novelty, margin(map, slot_of(frame), waiting.row));
    }
    if (frame >= oldest && (!last_found_ || frame > last_found_->frame)) {
      last_found_ = JumpRate::Found{frame, waiting.row};
    }
    if (grows_) continue;
    jump_rate_.take(map, frame, waiting.row, hops(map, waiting) ? frame : began);
  }
  // Frames from before a gap have all been answered now.
  oldest_before_ = oldest;
  while (first_ < end_ && !at(first_).waits) ++first_;
}

/// Whether nothing that comes later is likely to change a frame's answer. Where a robot localises,
/// a trace seldom ends but because it was carried away, and may look for long as if it went on: so
/// what is said has to be enough even if the trace has been left since.
bool PendingAnswers::is_sure(const PlaceMap& map, const Waiting& waiting) noexcept {
  return waiting.believed && waiting.lag >= 2 * after_centre_ &&
         (grows_ || waiting.right * waiting.carried.left >= least_before_calibration_) &&
         told(map, waiting) >= least_before_calibration_;
}

/// Whether a row near this one, of another session, may be the place that a frame shows, too.
bool PendingAnswers::knows_another_session(const PlaceMap& map, const Waiting& waiting,
                                           std::size_t row) noexcept {
  const PlaceOrder& order = map.order();
  if (row >= map.size() || order.around(row).first == order.around(waiting.row).first) return false;
  const auto lines = lines_in(slot_of(waiting.frame)).first(waiting.lines);
  return std::ranges::any_of(lines, [&](const FoundLine& line) {
    return line.may_be_here && order.apart(line.row, row) <= own + 2 * frames_at_a_meeting;
  });
}

/// Whether a frame's place may be where another session leads from where the robot was before: then
/// the way to it is as good as unknown.
bool PendingAnswers::hops(const PlaceMap& map, const Waiting& waiting) noexcept {
  const auto& before = jump_rate_.last();
  if (!before || waiting.frame <= before->frame) return false;
  const std::size_t row = before->row + static_cast<std::size_t>(waiting.frame - before->frame);
  return row < map.order().around(before->row).last && knows_another_session(map, waiting, row);
}

/// Whether a frame beside this one was on a trace that goes through another place. Where the robot
/// has been carried away before, it is enough that a frame after it may not be on this one any
/// more.
bool PendingAnswers::is_beside_a_jump(const PlaceMap& map, const Waiting& waiting) noexcept {
  const bool carried = jump_rate_.chance() > 0.0;
  const std::uint64_t first = waiting.frame - std::min(waiting.frame, frames_at_a_meeting);
  const std::uint64_t last = std::min(waiting.frame + frames_at_a_meeting + 1, end_);
  for (std::uint64_t frame = first; frame < last; ++frame) {
    const Waiting& other = at(frame);
    if (other.frame != frame) continue;
    constexpr double half = 0.5;
    constexpr double surely = 0.97;
    const double on_a_trace = other.believed ? probability(other) : 0.0;
    if (carried && frame > waiting.frame && on_a_trace <= surely) return true;
    if (on_a_trace <= half) continue;
    if (map.order().apart(other.row, waiting.row) <= own + 2 * frames_at_a_meeting) continue;
    if (knows_another_session(map, waiting, other.row)) continue;
    const bool both_there = std::max(other.row, waiting.row) < map.size();
    if (!both_there || !map.same_place(other.row, waiting.row)) return true;
  }
  return false;
}

/// Whether a whole window after a frame went on along the trace, and the frame's own window goes
/// along it better than elsewhere: much better, if the trace begins in that window.
bool PendingAnswers::is_borne_out(const PlaceMap& map, const Waiting& waiting) noexcept {
  constexpr double much = 0.1;
  if (waiting.lag <= 2 * after_centre_) return false;
  const double least = lies_on_trace(map.order(), waiting.frame) ? 0.0 : much;
  return margin(map, slot_of(waiting.frame), waiting.row) >= least;
}

/// What is told of a frame, before it is calibrated.
double PendingAnswers::told(const PlaceMap& map, const Waiting& waiting) noexcept {
  const double is_there = probability(waiting);
  // Frames at the ends of a revisit lie on its trace together, or not: by their sum they are surer
  // than they should be.
  constexpr double surely_on = 0.9995;
  constexpr double hardly_sure = 0.7;
  if (grows_ && waiting.on.still < surely_on) return std::min(is_there, hardly_sure);
  if (is_there <= most_in_doubt) return is_there;
  if (waiting.doubted) return most_in_doubt;
  if (is_beside_a_jump(map, waiting)) return most_in_doubt;
  const double if_carried = waiting.right * waiting.carried.where(waiting.left);
  if (if_carried < is_there && is_borne_out(map, waiting)) return is_there;
  return std::clamp(if_carried, most_in_doubt, is_there);
}

/// Whether enough has been seen to say that a place is new. A robot that is switched on may be on
/// the map: before a window is whole nothing has been found, whether it is or not.
/// @param began the first frame that belongs together with those that are answered
bool PendingAnswers::may_be_new(const PlaceMap& map, std::uint64_t began) const noexcept {
  return !PlaceBelief::has_earlier_drives(!grows_, map.order()) ||
         end_ - began >= trajectories_->window();
}

void PendingAnswers::give(PlaceMap& map, const FrameSteps& steps, Waiting& waiting,
                          bool may_be_new) noexcept {
  waiting.waits = false;
  Answer& answer = answers_[given_++];
  answer = {waiting.frame, Gate::frame_error, 0.0F, std::nullopt};
  if (!waiting.readable) return;
  const Gate otherwise = may_be_new ? Gate::new_place : Gate::unsure;
  answer.gate = otherwise;
  if (!waiting.believed) return;
  answer.probability = static_cast<float>(calibrated(told(map, waiting)));
  answer.match = match(map, waiting.frame);
  const bool sure = accepts(answer.probability);
  constexpr double half = 0.5;
  const bool is_new = waiting.new_place > half && static_cast<double>(answer.probability) < half;
  answer.gate = sure ? Gate::match : is_new ? otherwise : Gate::unsure;
  if (grows_) link(map, steps, waiting);
}

/// Where frame and row show one place, they are visits of it. That is not asked for more, as an
/// answer is: a place whose visits are not known to be one looks less sure with each of them.
void PendingAnswers::link(PlaceMap& map, const FrameSteps& steps, Waiting waiting) noexcept {
  waiting.right = waiting.same_place;
  if (calibrated(told(map, waiting)) < PlaceMap::likely || waiting.row >= map.size()) return;
  // The frame is a place, too, unless the map was full.
  const std::uint64_t frame = steps.frame_of(waiting.frame);
  const std::size_t row = map.order().row_of_frame(frame);
  if (row < map.size() && map.order().frame(row) == frame) map.link(row, waiting.row);
}

std::optional<FoundLine> PendingAnswers::line_near(const PlaceMap& map,
                                                   std::uint64_t frame) noexcept {
  const Waiting& waiting = at(frame);
  if (waiting.frame != frame || !waiting.believed) return std::nullopt;
  for (const FoundLine& line : lines_in(slot_of(frame)).first(waiting.lines)) {
    const std::size_t off = map.order().apart(line.row, waiting.row);
    const bool other_visit =
        off > PlaceMap::beside && line.row < map.size() && map.same_place(line.row, waiting.row);
    if (off <= own || other_visit) return line;
  }
  return std::nullopt;
}

/// Whether the trace goes through the whole window of a frame, and no slower than lines do: where
/// the robot passes far fewer places a frame, as in a map of every fifth one, no line knows the
/// row.
bool PendingAnswers::lies_on_trace(const PlaceOrder& order, std::uint64_t frame) noexcept {
  const std::uint64_t before = trajectories_->centre();
  if (frame < before) return false;
  constexpr double half = 0.5;
  constexpr double slower = 0.05;
  const Waiting& first = at(frame - before);
  const Waiting& last = at(frame + after_centre_);
  const std::uint64_t frames = before + after_centre_;
  const double least = (trajectories_->velocity(0) - slower) * static_cast<double>(frames);
  // Up to 2 rows a frame, as the belief moves.
  return first.frame == frame - before && last.frame == frame + after_centre_ && first.believed &&
         last.believed && std::min(probability(first), probability(last)) > half &&
         first.row <= last.row && order.apart(first.row, last.row) <= 2 * frames &&
         static_cast<double>(last.row - first.row) >= least;
}

/// Whether no place on a line has been thinned out.
bool PendingAnswers::has_all(const PlaceMap& map, const FoundLine& line) const noexcept {
  const auto offsets = trajectories_->offsets(line.line);
  const auto row = [&](std::int64_t by) {
    return static_cast<std::size_t>(
        std::max<std::int64_t>(static_cast<std::int64_t>(line.row) + by, 0));
  };
  return line.row < map.size() && map.has_all(row(offsets.front()), row(offsets.back()));
}

Match PendingAnswers::match(const PlaceMap& map, std::uint64_t frame) noexcept {
  const PlaceOrder& order = map.order();
  // A row that is `by` rows from another, or as far that way as its session goes.
  const auto number = [&](std::size_t row, std::int64_t by) {
    const CandidateRun session = order.around(std::min(row, map.size() - 1));
    const std::int64_t there =
        std::clamp(static_cast<std::int64_t>(row) + by, static_cast<std::int64_t>(session.first),
                   static_cast<std::int64_t>(session.last) - 1);
    return order.number(static_cast<std::size_t>(there));
  };
  // The line through the frame itself, or the nearest one that reaches it; one whose window lies on
  // the trace from end to end, if there is any. Otherwise the trace knows the row better. A line
  // that does worse than one elsewhere comes after those that do not. One as slow or as fast as
  // lines are comes after one near by that is not and does as well: the robot may have been slower
  // or faster still.
  enum class Line { between, best, whole, any };
  const auto through_it = line_near(map, frame);
  const double well =
      through_it ? std::max(0.0, margin(map, slot_of(frame), through_it->row)) : 0.0;
  const std::size_t fastest = trajectories_->count() - 1;
  for (const Line wanted : {Line::between, Line::best, Line::whole, Line::any}) {
    const bool whole = wanted != Line::any;
    const std::size_t farthest = trajectories_->window() / (wanted == Line::between ? 5 : 2);
    const double least = wanted == Line::between ? well : 0.0;
    for (std::uint64_t off = 0; off <= farthest; ++off) {
      for (const bool after : {true, false}) {
        if (!after && (off == 0 || frame < off)) continue;
        const std::uint64_t other = after ? frame + off : frame - off;
        if (other >= end_ || (after && off > trajectories_->centre())) continue;
        const auto line = line_near(map, other);
        if (!line) continue;
        if (whole && !(has_all(map, *line) && lies_on_trace(order, other))) continue;
        if (wanted <= Line::best && margin(map, slot_of(other), line->row) < least) continue;
        if (wanted == Line::between && (line->line == 0 || line->line == fastest)) continue;
        const auto offsets = trajectories_->offsets(line->line);
        const std::size_t from = whole ? line->row : at(frame).row;
        const std::int64_t there =
            whole ? offsets[static_cast<std::size_t>(trajectories_->centre() + frame - other)] : 0;
        // Line and trace err each in its own way: half way between them errs least. Another visit's
        // rows are no neighbours of the trace's.
        std::int64_t aside = 0;
        if (const std::size_t traced = at(frame).row;
            order.apart(from, traced) <= trajectories_->window()) {
          aside = (static_cast<std::int64_t>(traced) - static_cast<std::int64_t>(from) - there) / 2;
        }
        return {number(from, there + aside), static_cast<float>(line->score),
                static_cast<float>(line->uniqueness), trajectories_->velocity(line->line),
                number(from, offsets.back() + aside)};
      }
    }
  }
  const std::size_t row = at(frame).row;
  return {number(row, 0), undefined_float, undefined_float, undefined,
          number(row, static_cast<std::int64_t>(after_centre_))};
}

void PendingAnswers::removed(std::size_t row, bool forgotten) noexcept {
  if (last_found_) count_without(row, forgotten, last_found_->row);
  for (Waiting& waiting : waiting_) {
    count_without(row, forgotten, waiting.row);
    count_without(row, forgotten, waiting.likeliest);
    // Where the robot was can be named no more.
    waiting.believed = waiting.believed && waiting.row != none;
  }
  for (FoundLine& line : lines_) count_without(row, forgotten, line.row);
}

void PendingAnswers::inserted(std::size_t row) noexcept {
  jump_rate_.inserted(row);
  if (last_found_) count_with(row, last_found_->row);
  for (Waiting& waiting : waiting_) {
    count_with(row, waiting.row);
    count_with(row, waiting.likeliest);
  }
  for (FoundLine& line : lines_) count_with(row, line.row);
}

}  // namespace seqloop
