// SPDX-License-Identifier: MIT
#include "seqloop/detail/trace_span.hpp"

#include <algorithm>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

/// Chances of a frame: a trace begins, or ends.
struct Chances {
  double begins;
  double ends;
};
constexpr Chances usual_chances{0.01, 0.001};

/// Where the pictures go on from one to the next, a frame that is as new as can be is a cut: the
/// robot was carried away, or the camera was covered. Drives whose frames are all new show none.
/// @param least half of what is new of this drive's frames
Chances chances_of(double novelty, double least) {
  constexpr double all_new = 0.6;
  constexpr double goes_on = 0.15;
  const bool cut = novelty > all_new && least < goes_on;
  return cut ? Chances{0.9, 0.95} : usual_chances;
}

/// What a frame has to gain, by novelty, where the belief of the time did not agree with the trace
/// yet: nearly as much as the frames since have gained.
/// @param agreed the frames since
double usual_before(std::span<const BeliefTraces::Step> agreed, double usual, double least) {
  double gained = 0.0;
  double novelty = 0.0;
  for (const BeliefTraces::Step& step : agreed) {
    gained += step.gain;
    novelty += std::max(step.novelty, least);
  }
  constexpr double nearly = 0.9;
  return novelty > 0.0 ? std::max(usual, nearly * gained / novelty) : usual;
}

/// How likely the frames that follow are, by where the robot is.
struct Backward {
  double fresh;
  double on;
  double gone;

  /// To the frame before. @param likelier of the frame that it comes from
  void step(double likelier, const Chances& chances) {
    const double stays = likelier * on;
    fresh = (1.0 - chances.begins) * fresh + chances.begins * stays;
    on = (1.0 - chances.ends) * stays + chances.ends * gone;
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
                                               std::size_t agreed, double before, double usual,
                                               double least, std::size_t asked) noexcept {
  const double early = usual_before(trace.first(agreed), usual, least);
  double fresh = 1.0 - before;
  double on = 1.0;
  double gone = 0.0;
  for (std::size_t back = trace.size(); back-- > 0;) {
    const BeliefTraces::Step& step = trace[back];
    const double elsewhere = (back < agreed ? usual : early) * std::max(step.novelty, least);
    const double likelier = exponential(step.gain - elsewhere);
    const Chances chances = chances_of(step.novelty, least);
    if (back + 1 < trace.size()) {
      gone += on * chances.ends;
      on = on * (1.0 - chances.ends) + fresh * chances.begins;
      fresh *= 1.0 - chances.begins;
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
  Backward left{0.0, usual_chances.ends, 1.0};
  for (std::size_t back = 0; back < asked; ++back) {
    const Forward& here = forward_[back];
    const auto share = [&here](const Backward& after) {
      const double is = here.on * after.on;
      return is / (is + here.fresh * after.fresh + here.gone * after.gone);
    };
    on_[back] = {share(still), share(left)};
    const Chances chances = chances_of(trace[back].novelty, least);
    still.step(here.likelier, chances);
    left.step(here.likelier, chances);
  }
  return on_.first(asked);
}

}  // namespace seqloop
