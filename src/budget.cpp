// SPDX-License-Identifier: MIT
#include "seqloop/budget.hpp"

namespace seqloop {
namespace {

bool over(Nanoseconds time, Nanoseconds limit) { return limit.count() > 0 && time > limit; }

}  // namespace

Misses misses(const StageTimes& times, const Budget& budget) noexcept {
  return {over(times.total, budget.total), over(times.age, budget.age),
          over(times.grab, budget.grab), over(times.describe, budget.describe),
          over(times.match, budget.match)};
}

bool OverloadWatch::observe(bool missed) noexcept {
  in_a_row_ = missed == overloaded_ ? 0 : in_a_row_ + 1;
  if (in_a_row_ < (overloaded_ ? rule_.recover : rule_.after)) return false;
  in_a_row_ = 0;
  overloaded_ = !overloaded_;
  if (overloaded_) ++episodes_;
  return true;
}

}  // namespace seqloop
