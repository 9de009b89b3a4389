// SPDX-License-Identifier: MIT
#include "seqloop/detail/wrong_rows.hpp"

#include <cmath>

namespace seqloop {

void WrongRows::Level::learn(const Frame& frame) noexcept {
  constexpr double longest = 300.0;
  double sum = frame.other ? std::max(frame.other->sum, least) : least;
  // Somewhere new the likeliest row is a wrong one too.
  if (!frame.on_map && frame.likeliest) sum = std::max(sum, frame.likeliest->sum);
  if (weight == 0.0) {
    mean = sum;
    novelty = frame.novelty;
  }
  const double share = 1.0 / std::min(weight + 1.0, longest);
  weight += 2.0 * frame.novelty;
  const double off = sum - mean;
  mean += share * off;
  variance = (1.0 - share) * (variance + share * off * off);
  novelty += share * (frame.novelty - novelty);
}

void WrongRows::take(const Frame& frame) noexcept {
  if (const Frame* const known = due()) {
    if (known->novelty > 0.0) known_.learn(*known);
  } else {
    ++count_;
  }
  newest_ = (newest_ + 1) % lag;
  frames_[newest_] = frame;
  now_ = known_;
  for (std::size_t back = count_; back-- > 0;) {
    const Frame& guess = frames_[(newest_ + lag - back) % lag];
    if (guess.novelty > 0.0) now_.learn(guess);
  }
}

void WrongRows::settle() noexcept {
  known_ = now_;
  count_ = 0;
}

double WrongRows::lead(double sum) const noexcept {
  // There are wrong rows in store that do better than those that were met.
  constexpr double least_variance = 1.25;
  return (sum - now_.mean) / std::sqrt(now_.variance + least_variance);
}

}  // namespace seqloop
