// SPDX-License-Identifier: MIT
#include "layout.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop::street {

Layout::Layout(const Path& path, std::size_t leg, double p)
    : pieces_(path.around(leg, p, kBehind, kAhead)),
      begin_(p - kBehind),
      heading_(path.heading(leg, p)) {
  constexpr auto kHere = static_cast<std::size_t>(kBehind / kStep);
  constexpr auto kCount = static_cast<std::size_t>((kBehind + kAhead) / kStep) + 1;
  samples_.resize(kCount);
  std::size_t piece = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double at = begin_ + kStep * static_cast<double>(i);
    while (piece + 1 < pieces_.size() && at >= pieces_[piece].end) ++piece;
    samples_[i].turn = wrap_angle(path.heading(pieces_[piece].leg, at) - heading_);
  }
  samples_[kHere].x = samples_[kHere].y = 0.0;
  const auto step_x = [&](std::size_t a, std::size_t b) {
    return kStep * 0.5 * (std::cos(samples_[a].turn) + std::cos(samples_[b].turn));
  };
  const auto step_y = [&](std::size_t a, std::size_t b) {
    return kStep * 0.5 * (std::sin(samples_[a].turn) + std::sin(samples_[b].turn));
  };
  for (std::size_t i = kHere + 1; i < kCount; ++i) {
    samples_[i].x = samples_[i - 1].x + step_x(i - 1, i);
    samples_[i].y = samples_[i - 1].y + step_y(i - 1, i);
  }
  for (std::size_t i = kHere; i-- > 0;) {
    samples_[i].x = samples_[i + 1].x - step_x(i, i + 1);
    samples_[i].y = samples_[i + 1].y - step_y(i, i + 1);
  }
}

Layout::Sample Layout::at(double p) const noexcept {
  const double last = static_cast<double>(samples_.size() - 1);
  const double t = std::clamp((p - begin_) / kStep, 0.0, last - 1e-9);
  const auto i = static_cast<std::size_t>(t);
  const double f = t - static_cast<double>(i);
  const Sample& a = samples_[i];
  const Sample& b = samples_[i + 1];
  return {a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f, a.turn + wrap_angle(b.turn - a.turn) * f};
}

Vec3 Layout::place(double p, double d, double z) const noexcept {
  const Sample c = at(p);
  return {c.x - d * std::sin(c.turn), c.y + d * std::cos(c.turn), z};
}

double Layout::turn(double p) const noexcept { return at(p).turn; }

}  // namespace seqloop::street
