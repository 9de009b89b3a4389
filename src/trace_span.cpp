// SPDX-License-Identifier: MIT
#include "seqloop/detail/trace_span.hpp"

#include <algorithm>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

// Chances of a frame: a trace begins, or ends.
constexpr double begins = 0.01;
constexpr double ends = 0.001;

/// How likely the frames that follow are, by where the robot is.
struct Backward {
  double fresh;
  double on;
  double gone;

  /// To the frame before. @param likelier of the frame that it comes from
  void step(double likelier) {
    const double stays = likelier * on;
    fresh = (1.0 - begins) * fresh + begins * stays;
    on = (1.0 - ends) * stays + ends * gone;
    const double sum = fresh + on + gone;
    fresh /= sum;
    on /= sum;
    gone /= sum;
  }
};

}  // namespace

TraceSpan::TraceSpan(Arena& arena, std::size_t most)
    : forward_(arena.take<Forward>("where a trace may begin and end", most)),
      on_(arena.take<On>("frames on a trace", most)) {}

std::span<const TraceSpan::On> TraceSpan::find(std::span<const BeliefTraces::Step> trace,
                                               double before, double usual, double least,
                                               std::size_t asked) noexcept {
  double fresh = 1.0 - before;
  double on = 1.0;
  double gone = 0.0;
  for (std::size_t back = trace.size(); back-- > 0;) {
    const BeliefTraces::Step& step = trace[back];
    const double likelier = exponential(step.gain - usual * std::max(step.novelty, least));
    if (back + 1 < trace.size()) {
      gone += on * ends;
      on = on * (1.0 - ends) + fresh * begins;
      fresh *= 1.0 - begins;
    }
    on *= likelier;
    // Their sum is kept at 1, so that no trace is too long to be counted.
    const double sum = fresh + on + gone;
    fresh /= sum;
    on /= sum;
    gone /= sum;
    forward_[back] = {fresh, on, gone, likelier};
  }
  Backward still{1.0, 1.0, 1.0};
  Backward left{0.0, ends, 1.0};
  for (std::size_t back = 0; back < asked; ++back) {
    const Forward& here = forward_[back];
    const auto share = [&here](const Backward& after) {
      const double is = here.on * after.on;
      return is / (is + here.fresh * after.fresh + here.gone * after.gone);
    };
    on_[back] = {share(still), share(left)};
    still.step(here.likelier);
    left.step(here.likelier);
  }
  return on_.first(asked);
}

}  // namespace seqloop
