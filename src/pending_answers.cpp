// SPDX-License-Identifier: MIT
#include "seqloop/detail/pending_answers.hpp"

#include <algorithm>
#include <limits>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr float undefined_float = std::numeric_limits<float>::quiet_NaN();

// A line is a trace's own if it lies so near it.
constexpr std::size_t own = 6;

// Chances of a frame: a trace begins, or ends.
constexpr double begins = 0.003;
constexpr double ends = 0.003;

}  // namespace

PendingAnswers::PendingAnswers(Arena& arena, const MatcherConfig& config,
                               const Trajectories& trajectories)
    : trajectories_(&trajectories),
      patience_(config.patience),
      after_centre_(config.sequence_length - config.sequence_length / 2),
      grows_(config.use == Use::close_loops),
      least_(static_cast<double>(config.min_probability)) {
  const bool used = config.decision == Decision::probability;
  const std::size_t kept = config.patience + config.sequence_length + 2;
  waiting_ = arena.take<Waiting>("frames that wait for their answer", used ? kept : 0);
  lines_ = arena.take<FoundLine>("lines found for them", used ? kept * lines_kept : 0);
  answers_ = arena.take<Answer>(
      "answers", used ? config.patience + config.frames_at_once + 1 : config.frames_at_once);
  trace_ = arena.take<PlaceBelief::Step>("the likeliest trace", used ? config.patience + 1 : 0);
  weights_ = arena.take<Ends>("where a trace may begin and end", used ? config.patience + 1 : 0);
}

void PendingAnswers::add(std::uint64_t frame, bool readable) noexcept {
  at(frame) = {frame, true, readable, false, 0, 0, 0.0, 0.0, 0, 1.0, 0};
  end_ = frame + 1;
}

void PendingAnswers::found(std::uint64_t frame, std::span<const FoundLine> lines) noexcept {
  if (at(frame).frame != frame) return;
  at(frame).lines = lines.size();
  std::ranges::copy(lines, lines_of(frame).begin());
}

void PendingAnswers::believe(PlaceBelief& belief, const PlaceMap& map,
                             std::uint64_t newest) noexcept {
  const PlaceOrder& order = map.order();
  evidence_.reset();
  const auto& likeliest = belief.likeliest();
  at(newest).new_place = belief.new_place();
  if (!likeliest) return;
  const std::size_t length = belief.trace(likeliest->index, trace_);
  evidence_ = likeliest->evidence;
  ask_windows(map, newest, length);
  evidence_->past = belief.remember(log_odds_now(*evidence_));
  const double odds = log_odds(*evidence_);
  // Where the trace may have begun, and ended: by what its frames said. Chances of both, frame by
  // frame; back from the newest.
  if (length == 0) return;
  // A trace that was sure of its oldest frame did not enter later.
  const Waiting& oldest = at(newest - (length - 1));
  const bool known = oldest.believed && oldest.frame == newest - (length - 1) && oldest.asked > 1 &&
                     order.apart(oldest.row, trace_[length - 1].row) <= own;
  const double off = known ? 1.0 - logistic(oldest.odds) * oldest.on : 1.0;
  const double usual = exponential(-belief.usual_gain());
  double said = 0.0;
  double unusual = 1.0;
  double entered = 0.0;  // at any frame
  double gone = 0.0;
  for (std::size_t back = 0; back < length; ++back) {
    said += trace_[back].gain;
    unusual *= usual;
    const double likelier = exponential(said);
    weights_[back] = {(back + 1 == length ? 1.0 : begins * off) * likelier * unusual,
                      ends / likelier};
    entered += weights_[back].entered;
    gone += weights_[back].gone;
  }
  double later = 0.0;  // entered after this frame
  for (std::size_t back = 0; back < length; ++back) {
    const std::uint64_t frame = newest - back;
    Waiting& waiting = at(frame);
    // Entered at this frame or before it, and not gone by then.
    const double on = std::max(0.0, entered - later) / entered / (1.0 + gone);
    later += weights_[back].entered;
    gone = std::max(0.0, gone - weights_[back].gone);
    if (!waiting.waits || waiting.frame != frame) continue;
    const bool same = waiting.believed && order.apart(waiting.row, trace_[back].row) <= own;
    if (!same && waiting.believed) {
      // One of the two is wrong.
      const double now = logistic(odds) * on;
      if (logistic(waiting.odds) * waiting.on > now) {
        waiting.on = std::min(waiting.on, 1.0 - now);
        continue;
      }
    }
    if (!same) waiting.asked = 0;
    ++waiting.asked;
    waiting.odds =
        same ? waiting.odds + (odds - waiting.odds) / static_cast<double>(waiting.asked) : odds;
    waiting.lag = back;
    waiting.on = on;
    waiting.row = trace_[back].row;
    waiting.believed = true;
  }
}

/// What sequence search says of the frames along the trace.
void PendingAnswers::ask_windows(const PlaceMap& map, std::uint64_t newest,
                                 std::size_t length) noexcept {
  constexpr std::size_t windows = 10;
  std::size_t asked = 0;
  for (std::size_t back = after_centre_; back < length && asked < windows; ++back) {
    const std::uint64_t frame = newest - back;
    if (at(frame).frame != frame || at(frame).lines == 0) continue;
    ++asked;
    double here = 0.0;
    double elsewhere = 0.0;
    for (const FoundLine& line : lines_of(frame).first(at(frame).lines)) {
      const bool same = line.row < map.size() && map.same_place(line.row, trace_[back].row);
      double& lowest = same ? here : elsewhere;
      if (lowest == 0.0) lowest = line.score;
    }
    constexpr double most = 0.2;
    double margin = here == 0.0 ? -most : most;
    if (here > 0.0 && elsewhere > 0.0) {
      margin = std::clamp(logarithm(elsewhere / here), -most, most);
    }
    evidence_->margin += margin / static_cast<double>(windows);
  }
}

void PendingAnswers::answer(PlaceMap& map, std::uint64_t newest, std::uint64_t oldest) noexcept {
  for (std::uint64_t frame = first_; frame < end_; ++frame) {
    Waiting& waiting = at(frame);
    if (!waiting.waits || waiting.frame != frame) continue;
    const bool late = frame < oldest || newest - frame >= patience_;
    const bool sure = waiting.believed && waiting.lag >= after_centre_ + after_centre_ / 2 &&
                      logistic(waiting.odds) * waiting.on >= least_;
    if (late || sure || !waiting.readable) give(map, newest, waiting);
  }
  while (first_ < end_ && !at(first_).waits) ++first_;
}

void PendingAnswers::give(PlaceMap& map, std::uint64_t newest, Waiting& waiting) noexcept {
  waiting.waits = false;
  Answer& answer = answers_[given_++];
  answer = {waiting.frame, Gate::frame_error, 0.0F, std::nullopt};
  if (!waiting.readable) return;
  answer.gate = Gate::new_place;
  if (!waiting.believed) return;
  // What was last said of the frame was said too early to know whether the trace was left by then.
  constexpr double early = 0.9;
  const bool left = waiting.lag < std::min<std::uint64_t>(after_centre_, newest - waiting.frame);
  answer.probability =
      static_cast<float>(logistic(waiting.odds) * waiting.on * (left ? early : 1.0));
  answer.match = match(map, waiting.frame);
  const bool sure = static_cast<double>(answer.probability) >= least_;
  constexpr double half = 0.5;
  const bool is_new = waiting.new_place > half && static_cast<double>(answer.probability) < half;
  answer.gate = sure ? Gate::match : is_new ? Gate::new_place : Gate::unsure;
  // The frame is a place too, unless the map was full.
  constexpr float likely = 0.9F;
  if (!grows_ || answer.probability < likely || waiting.row >= map.size()) return;
  const std::size_t row = map.order().row_of_frame(waiting.frame);
  if (row < map.size() && map.order().frame(row) == waiting.frame) map.link(row, waiting.row);
}

std::optional<FoundLine> PendingAnswers::line_near(const PlaceMap& map,
                                                   std::uint64_t frame) noexcept {
  const Waiting& waiting = at(frame);
  if (waiting.frame != frame || !waiting.believed) return std::nullopt;
  for (const FoundLine& line : lines_of(frame).first(waiting.lines)) {
    constexpr std::size_t beside = 10;
    const std::size_t off = map.order().apart(line.row, waiting.row);
    const bool other_visit =
        off > beside && line.row < map.size() && map.same_place(line.row, waiting.row);
    if (off <= own || other_visit) return line;
  }
  return std::nullopt;
}

Match PendingAnswers::match(const PlaceMap& map, std::uint64_t frame) noexcept {
  const PlaceOrder& order = map.order();
  // A row that is `by` rows from another, or as far that way as its session goes.
  const auto number = [&](std::size_t row, std::int64_t by) {
    const CandidateRun session = order.around(std::min(row, map.size() - 1));
    const std::int64_t there =
        std::clamp(static_cast<std::int64_t>(row) + by, static_cast<std::int64_t>(session.first),
                   static_cast<std::int64_t>(session.last) - 1);
    return static_cast<std::size_t>(order.number(static_cast<std::size_t>(there)));
  };
  // The line through the frame itself, or the nearest one that reaches it.
  for (std::uint64_t off = 0; off <= trajectories_->window() / 2; ++off) {
    for (const bool after : {true, false}) {
      if (!after && (off == 0 || frame < off)) continue;
      const std::uint64_t other = after ? frame + off : frame - off;
      if (other >= end_ || (after && off > trajectories_->centre())) continue;
      const auto line = line_near(map, other);
      if (!line) continue;
      const auto offsets = trajectories_->offsets(line->line);
      // From there on as the trace goes.
      const std::int64_t on =
          static_cast<std::int64_t>(at(frame).row) - static_cast<std::int64_t>(at(other).row);
      return {number(line->row, on), static_cast<float>(line->score),
              static_cast<float>(line->uniqueness), trajectories_->velocity(line->line),
              number(line->row, offsets.back())};
    }
  }
  const std::size_t row = at(frame).row;
  return {number(row, 0), undefined_float, undefined_float, undefined,
          number(row, static_cast<std::int64_t>(after_centre_))};
}

void PendingAnswers::removed(std::size_t row) noexcept {
  for (Waiting& waiting : waiting_) {
    if (waiting.row > row) --waiting.row;
  }
  for (FoundLine& line : lines_) {
    if (line.row > row) --line.row;
  }
}

}  // namespace seqloop
