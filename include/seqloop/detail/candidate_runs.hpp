// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// Rows [first, last) of the map.
struct CandidateRun {
  std::size_t first;
  std::size_t last;
};

/// The rows that a frame is compared with, as disjoint runs in rising order that do not touch.
class CandidateRuns {
 public:
  /// @param most runs that will be added to an empty set at most
  /// Allocates: from the arena only.
  CandidateRuns(Arena& arena, std::size_t most)
      : runs_(arena.take<CandidateRun>("candidate runs", most)) {}

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::span<const CandidateRun> runs() const noexcept { return runs_.first(count_); }

  /// Calls `work(part)` for the parts of a run that are not in the set, in rising order.
  template <class Work>
  void for_each_outside(CandidateRun run, Work work) const noexcept {
    for (const CandidateRun inside : runs()) {
      if (inside.last <= run.first) continue;
      if (inside.first >= run.last) break;
      if (run.first < inside.first) work(CandidateRun{run.first, inside.first});
      run.first = inside.last;
    }
    if (run.first < run.last) work(run);
  }

  /// Adds a run, uniting it with those that it overlaps or touches.
  void add(CandidateRun run) noexcept {
    if (run.first >= run.last) return;
    const auto begin = runs_.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(count_);
    const auto first = std::find_if(begin, end, [&](auto r) { return r.last >= run.first; });
    const auto last = std::find_if(first, end, [&](auto r) { return r.first > run.last; });
    if (first == last) {
      std::move_backward(first, end, end + 1);
      ++count_;
    } else {
      run = {std::min(run.first, first->first), std::max(run.last, (last - 1)->last)};
      std::move(last, end, first + 1);
      count_ -= static_cast<std::size_t>(last - first) - 1;
    }
    *first = run;
  }

 private:
  std::size_t count_ = 0;
  std::span<CandidateRun> runs_;  // [most]
};

}  // namespace seqloop
