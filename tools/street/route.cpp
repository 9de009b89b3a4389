// SPDX-License-Identifier: MIT
#include "route.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math.hpp"

namespace seqloop::street {
namespace {

constexpr double kSection = 105.0;  // metres from one turn to the next
constexpr double kTurn = 58.0;      // metres a turn takes
constexpr double kSpread = 1.05;    // rad, headings of sections lie in +-kSpread

double ease(double t) noexcept {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

double wrap_angle(double angle) noexcept { return std::remainder(angle, 2.0 * kPi); }

double Street::section_heading(std::int64_t k) const noexcept {
  return kSpread * (2.0 * unit(hash_of(seed_, 0x726f6164, k)) - 1.0);
}

double Street::heading(double s) const noexcept {
  const double section = std::floor(s / kSection);
  const auto k = static_cast<std::int64_t>(section);
  const double t = ease((s - section * kSection - (kSection - kTurn)) / kTurn);
  const double here = section_heading(k);
  return here + (section_heading(k + 1) - here) * t + 0.05 * std::sin(s * 0.041);
}

Path::Path(Street street, std::vector<Leg> legs) : street_(street), legs_(std::move(legs)) {
  begins_.push_back(0.0);
  for (const Leg& leg : legs_) begins_.push_back(begins_.back() + leg.length);
  turn_in_.resize(legs_.size());
  turn_out_.resize(legs_.size());
  for (std::size_t k = 1; k < legs_.size(); ++k) {
    if (!legs_[k].joined) continue;
    const double before = street_.heading(legs_[k - 1].start + legs_[k - 1].length);
    const double turn = wrap_angle(before - street_.heading(legs_[k].start));
    if (legs_[k].fresh) {
      turn_in_[k] = turn;
    } else {
      turn_out_[k - 1] = -turn;
    }
  }
}

std::size_t Path::leg_at(double p) const noexcept {
  const auto after = std::upper_bound(begins_.begin() + 1, begins_.end() - 1, p);
  return static_cast<std::size_t>(after - begins_.begin()) - 1;
}

double Path::heading(std::size_t leg, double p) const noexcept {
  const double q = p - begins_[leg];
  const Leg& here = legs_[leg];
  double h = street_.heading(here.start + q);
  if (q < kBend) h += turn_in_[leg] * (1.0 - ease(q / kBend));
  if (q > here.length - kBend) h += turn_out_[leg] * ease((q - here.length + kBend) / kBend);
  return h;
}

bool Path::in_bend(std::size_t leg, double p) const noexcept {
  constexpr double kHard = 0.45;
  const double q = p - begins_[leg];
  return (std::fabs(turn_in_[leg]) > kHard && q < kBend) ||
         (std::fabs(turn_out_[leg]) > kHard && q > legs_[leg].length - kBend);
}

std::vector<Piece> Path::around(std::size_t leg, double p, double behind, double ahead) const {
  std::size_t first = leg;
  while (legs_[first].joined && first > 0 && begins_[first] > p - behind) --first;
  std::vector<Piece> pieces;
  double at = p - behind;
  for (std::size_t k = first; at < p + ahead; ++k) {
    const bool goes_on = k + 1 < legs_.size() && legs_[k + 1].joined;
    const double end = goes_on ? std::min(begins_[k + 1], p + ahead) : p + ahead;
    if (end > at) pieces.push_back({at, end, legs_[k].start - begins_[k], k});
    at = std::max(at, end);
  }
  return pieces;
}

}  // namespace seqloop::street
