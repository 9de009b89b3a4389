// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <limits>

namespace seqloop {

/// What the newest frame's likeliest row is judged by: the inputs of its probability.
struct Evidence {
  double odds = 0.0;      ///< ln of the belief in the row's place by that in all else
  double known = 0.0;     ///< -ln (1e-4 + the belief in "somewhere new")
  double lead = 0.0;      ///< how far it has done better than the best wrong rows usually do
  double contrast = 0.0;  ///< how much better it looks than the rows and frames around it
  double in_step = 0.0;   ///< how far it changes as the frames do, as `in_step` has it
  double age = 0.0;       ///< ln (1 + novel frames that have followed it)
  double margin = 0.0;    ///< ln of the best other place's score by this one's, mean of windows
  double doubt = 0.0;     ///< how much less the newest frames speak for it than for right rows
  double unlike = 0.0;    ///< how much less alike it looks than a place of just now would
  double jumps = 0.0;     ///< the chance of a jump, if it was found on this map lately, 0 .. .5
  double asked = 0.0;     ///< how much more the log-odds have to be, since much looks alike
};

/// From these odds on, a belief of .88, no other place rivals the likeliest one.
inline constexpr double least_odds = 2.0;

/// What the look of a place is worth. Of two that are alike both change as the frames do, so that
/// it counts only where there is no rival.
[[nodiscard]] inline double log_odds_of_look(const Evidence& e) noexcept {
  return e.odds < least_odds ? 1.094 * e.contrast : 0.6 * e.contrast + 15.0 * e.in_step;
}

/// The log-odds that the row is right, by a trace that has been followed for long: a logistic
/// regression, but for the .6 and 15 of the look. Source: src/README.md, section 6.4.
[[nodiscard]] inline double log_odds_followed(const Evidence& e) noexcept {
  return -5.879 + 0.104 * e.odds + 0.89 * e.lead + log_odds_of_look(e) + 0.808 * e.age +
         8.984 * e.margin;
}

/// The same by how little is left for all else, however short the trace is, by lines, and by how
/// the place changes. It says nothing of a place that has rivals: they may be as good. Source: as
/// above.
[[nodiscard]] inline double log_odds_alone(const Evidence& e) noexcept {
  if (e.odds < least_odds) return -std::numeric_limits<double>::infinity();
  return -4.0 + 1.116 * e.known + 10.0 * e.margin + 10.0 * e.in_step - 0.9 * e.doubt;
}

/// The log-odds that the row is right: either suffices. A robot that has been carried about on this
/// map, and was found again and again, is hardly on another that looks like it. What looks too
/// little like a place of just now is something that goes with the robot, or stands along its way
/// again and again.
[[nodiscard]] inline double log_odds(const Evidence& e) noexcept {
  constexpr double most = 2.0;
  const double carried_about = std::min(most, 10.0 * e.jumps);
  return std::max(log_odds_followed(e), log_odds_alone(e)) + carried_about - 40.0 * e.unlike;
}

/// The log-odds that the robot is there still, and was not carried away with the newest frames,
/// less what is asked.
[[nodiscard]] inline double log_odds_now(const Evidence& e) noexcept {
  return std::min(log_odds(e) - e.asked, 6.0) - 6.0 * e.doubt;
}

}  // namespace seqloop
