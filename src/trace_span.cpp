// SPDX-License-Identifier: MIT
#include "seqloop/detail/trace_span.hpp"

#include <algorithm>
#include <array>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

/// Chances of a frame: a trace begins, or ends.
struct Chances {
  double begins;
  double ends;
};
constexpr Chances localising{0.01, 0.001};
constexpr Chances closing_loops{0.001, 0.0};

/// The chance that a robot which has left the trace is on it again with a frame. It is small: the
/// frames in between have to say much against the trace.
constexpr double returns = 1e-5;

/// Where the pictures go on from one to the next, a frame that has changed as much as can be is a
/// cut: the robot was carried away, or the camera was covered. Drives whose frames are all new show
/// none.
/// @param least half of what is new of this drive's frames
/// @param usual of frames that are no cuts
Chances chances_of(double change, double least, const Chances& usual) {
  constexpr double all = 0.6;
  constexpr double goes_on = 0.15;
  const bool cut = change > all && least < goes_on;
  if (!cut) return usual;
  return {0.9, usual.ends > 0.0 ? 0.95 : 0.0};
}

/// What the frames gained by novelty on which the belief of the time agreed with the trace; 0 where
/// there are none.
double gain_by_novelty(std::span<const BeliefTraces::Step> agreed, double least) {
  double gained = 0.0;
  double novelty = 0.0;
  for (const BeliefTraces::Step& step : agreed) {
    gained += step.gain;
    novelty += std::max(step.novelty, least);
  }
  return novelty > 0.0 ? gained / novelty : 0.0;
}

/// How much likelier a frame is where the trace was left than where it has not begun: usual is what
/// the best of many wrong rows gain, but where the trace leads on is one row, of which half as much
/// is expected. About e^-(half of it), without the time that exponentials take.
double likelier_when_gone(double usual, double novelty) {
  constexpr double half = 0.5;
  return 1.0 / (1.0 + half * usual * novelty);
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
  Pair gone{1.0, 1.0};

  /// To the frame before. @param likelier, gone_likelier as `Forward` has them, of the frame that
  /// it comes from
  void step(double likelier, double gone_likelier, const Chances& chances) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double is_on = likelier * on[i];
      const double is_gone = gone_likelier * gone[i];
      fresh[i] = (1.0 - chances.begins) * fresh[i] + chances.begins * is_on;
      on[i] = (1.0 - chances.ends) * is_on + chances.ends * is_gone;
      gone[i] = (1.0 - returns) * is_gone + returns * is_on;
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

void TraceSpan::take_usual(std::span<BeliefTraces::Step> trace, std::size_t agreed,
                           std::size_t born, double usual, double least) const noexcept {
  constexpr double nearly = 0.9;
  constexpr double half = 0.5;
  const double since_agreed = localises_ ? 0.0 : 0.7;
  const double gained = gain_by_novelty(trace.first(agreed), least);
  for (std::size_t back = 0; back < trace.size(); ++back) {
    BeliefTraces::Step& step = trace[back];
    const double share = back < agreed ? since_agreed : back < born ? nearly : half;
    step.gain -= std::max(usual, share * gained) * std::max(step.novelty, least);
  }
}

std::span<const TraceSpan::On> TraceSpan::find(std::span<const BeliefTraces::Step> trace,
                                               double before, double usual, double least,
                                               double jumps, std::size_t asked) noexcept {
  constexpr double forgotten = 10.0;
  constexpr double tiny = 1e-200;  // so that there is something to divide by
  const Chances usual_chances =
      localises_ ? Chances{localising.begins, localising.ends + jumps} : closing_loops;
  double fresh = std::max({1.0 - before, std::min(1.0, forgotten * jumps), tiny});
  double on = 1.0;
  double gone = 0.0;
  for (std::size_t back = trace.size(); back-- > 0;) {
    const BeliefTraces::Step& step = trace[back];
    const double likelier = exponential(step.gain);
    const Chances chances = chances_of(step.change, least, usual_chances);
    if (back + 1 < trace.size()) {
      const double leaves = on * chances.ends;
      const double comes_back = gone * returns;
      on += fresh * chances.begins + comes_back - leaves;
      gone += leaves - comes_back;
      fresh *= 1.0 - chances.begins;
    }
    on *= likelier;
    const double gone_likelier = likelier_when_gone(usual, step.novelty);
    gone *= gone_likelier;
    if (const double sum = fresh + on + gone; is_far(sum)) {
      fresh = std::max(fresh / sum, tiny);
      on /= sum;
      gone /= sum;
    }
    forward_[back] = {fresh, on, gone, likelier, gone_likelier};
  }
  // Where no trace ends, one that was left was left after the newest frame only.
  Backward after{.on = {1.0, localises_ ? usual_chances.ends : 1.0}};
  for (std::size_t back = 0; back < asked; ++back) {
    const Forward& here = forward_[back];
    Pair share;
    for (std::size_t i = 0; i < 2; ++i) {
      const double is = here.on * after.on[i];
      share[i] = is / (is + here.fresh * after.fresh[i] + here.gone * after.gone[i]);
    }
    on_[back] = {share[0], share[1]};
    after.step(here.likelier, here.gone_likelier,
               chances_of(trace[back].change, least, usual_chances));
  }
  return on_.first(asked);
}

}  // namespace seqloop
