// SPDX-License-Identifier: MIT
#include "seqloop/detail/trace_span.hpp"

#include <algorithm>
#include <array>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

/// Chances of a frame: a trace begins, or ends, or a robot that has left it is on it again. The
/// last is small: the frames in between have to say much against the trace.
struct Chances {
  double begins;
  double ends;
  double returns;
};
constexpr Chances localising{0.01, 0.001, 1e-5};
constexpr Chances closing_loops{0.001, 0.001, 1e-10};

/// The same with a cut. Where loops are closed, a trace ends with none: somebody who walks past the
/// camera makes cuts, too.
constexpr Chances localising_at_cuts{0.9, 0.95, localising.returns};
constexpr Chances closing_loops_at_cuts{0.9, closing_loops.ends, closing_loops.returns};

/// Where the pictures go on from one to the next, a frame that has changed as much as can be is a
/// cut: the robot was carried away, or the camera was covered. Drives whose frames are all new show
/// none.
/// @param novelty what is usually new of this drive's frames
bool is_cut(double change, double novelty) {
  constexpr double all = 0.6;
  constexpr double goes_on = 0.3;
  return change > all && novelty < goes_on;
}

/// What frames gained by novelty; 0 where there was none.
double gain_by_novelty(std::span<const BeliefTraces::Step> trace) {
  double gained = 0.0;
  double novelty = 0.0;
  for (const BeliefTraces::Step& step : trace) {
    gained += step.gain + step.besides;
    novelty += step.novelty;
  }
  return novelty > 0.0 ? gained / novelty : 0.0;
}

/// Whether a sum of what is weighed leaves what can be counted. It is brought back to 1 then only:
/// shares do not change by it, and a frame would wait for the division of the one before.
bool is_far(double sum) {
  constexpr double far = 1e60;
  return sum > far || sum * far < 1.0;
}

/// If the trace goes on, and if it was left.
using Pair = std::array<double, 2>;

/// How likely the frames that follow are, by where the robot is.
struct Backward {
  Pair fresh{1.0, 0.0};
  Pair on;
  Pair gone;

  /// To the frame before. @param likelier, gone_likelier as `Forward` has them, of the frame that
  /// it comes from
  void step(double likelier, double gone_likelier, const Chances& chances) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double is_on = likelier * on[i];
      const double is_gone = gone_likelier * gone[i];
      fresh[i] = (1.0 - chances.begins) * fresh[i] + chances.begins * is_on;
      on[i] = (1.0 - chances.ends) * is_on + chances.ends * is_gone;
      gone[i] = (1.0 - chances.returns) * is_gone + chances.returns * is_on;
      const double sum = fresh[i] + on[i] + gone[i];
      if (!is_far(sum)) continue;
      fresh[i] /= sum;
      on[i] /= sum;
      gone[i] /= sum;
    }
  }
};

}  // namespace

TraceSpan::TraceSpan(Arena& arena, Use use, std::size_t most)
    : localises_(use == Use::localise),
      forward_(arena.take<Forward>("where a trace may begin and end", most)),
      on_(arena.take<On>("frames on a trace", most)) {}

void TraceSpan::ask(std::span<BeliefTraces::Step> trace, double least) const noexcept {
  constexpr double share = 0.7;
  for (auto left = trace; !left.empty();) {
    const auto end = std::ranges::find_if(
        left, [&](const BeliefTraces::Step& step) { return step.moved != left.front().moved; });
    const auto alike = left.first(static_cast<std::size_t>(end - left.begin()));
    left = left.subspan(alike.size());
    const double by_novelty = localises_ ? least : std::max(least, share * gain_by_novelty(alike));
    for (BeliefTraces::Step& step : alike) step.asked = by_novelty * step.novelty;
  }
}

/// How much likelier a frame is where the trace was left than where it has not begun. Usual is what
/// the best of many wrong rows gain, but where the trace leads on is one row: where a robot
/// localises half as much is expected of it, about e^-(half of it), without the time that
/// exponentials take. Where loops are closed more is asked than is usual, so that it counts what a
/// frame gains at all; and whether the belief of the time was elsewhere, since a street beside the
/// one that is known may look much like it.
double TraceSpan::likelier_when_gone(const BeliefTraces::Step& step, double usual) const noexcept {
  constexpr double half = 0.5;
  if (localises_) return 1.0 / (1.0 + half * usual * step.novelty);
  constexpr double by_novelty = 2.0;
  const double was_elsewhere = step.elsewhere ? by_novelty * step.novelty : 0.0;
  return exponential(std::min(0.0, was_elsewhere - step.asked));
}

std::span<const TraceSpan::On> TraceSpan::find(std::span<const BeliefTraces::Step> trace,
                                               double before, double usual, double novelty,
                                               double jumps, std::size_t asked) noexcept {
  constexpr double forgotten = 10.0;
  constexpr double tiny = 1e-200;  // so that there is something to divide by
  Chances usual_chances = localises_ ? localising : closing_loops;
  usual_chances.ends += jumps;
  const Chances& at_cuts = localises_ ? localising_at_cuts : closing_loops_at_cuts;
  const auto chances_of = [&](const BeliefTraces::Step& step) -> const Chances& {
    return is_cut(step.change, novelty) ? at_cuts : usual_chances;
  };
  double fresh = std::max({1.0 - before, std::min(1.0, forgotten * jumps), tiny});
  double on = 1.0;
  double gone = 0.0;
  for (std::size_t back = trace.size(); back-- > 0;) {
    const BeliefTraces::Step& step = trace[back];
    const double likelier = exponential(step.gain + step.besides - step.asked);
    const Chances& chances = chances_of(step);
    if (back + 1 < trace.size()) {
      const double leaves = on * chances.ends;
      const double comes_back = gone * chances.returns;
      on += fresh * chances.begins + comes_back - leaves;
      gone += leaves - comes_back;
      fresh *= 1.0 - chances.begins;
    }
    on *= likelier;
    const double gone_likelier = likelier_when_gone(step, usual);
    gone *= gone_likelier;
    if (const double sum = fresh + on + gone; is_far(sum)) {
      fresh = std::max(fresh / sum, tiny);
      on /= sum;
      gone /= sum;
    }
    forward_[back] = {fresh, on, gone, likelier, gone_likelier};
  }
  // Where loops are closed, a trace that was left was left after the newest frame only.
  Backward after = localises_ ? Backward{.on = {1.0, usual_chances.ends}, .gone = {1.0, 1.0}}
                              : Backward{.on = {1.0, 1.0}, .gone = {0.0, 0.0}};
  for (std::size_t back = 0; back < asked; ++back) {
    const Forward& here = forward_[back];
    Pair share;
    for (std::size_t i = 0; i < 2; ++i) {
      const double is = here.on * after.on[i];
      share[i] = is / (is + here.fresh * after.fresh[i] + here.gone * after.gone[i]);
    }
    on_[back] = {share[0], share[1]};
    after.step(here.likelier, here.gone_likelier, chances_of(trace[back]));
  }
  return on_.first(asked);
}

}  // namespace seqloop
