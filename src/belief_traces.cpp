// SPDX-License-Identifier: MIT
#include "seqloop/detail/belief_traces.hpp"

#include <algorithm>

#include "seqloop/detail/kept_row.hpp"

namespace seqloop {

BeliefTraces::BeliefTraces(Arena& arena, std::size_t depth, std::size_t width)
    : width_(width),
      parents_(arena.take<Index>("parents of hypotheses", depth * width)),
      steps_(arena.take<Traced>("traces of hypotheses", depth * width)),
      novelties_(arena.take<float>("novelties of frames", depth)),
      changes_(arena.take<float>("changes of frames", depth)) {}

void BeliefTraces::next(double novelty, double change) noexcept {
  frames_ = std::min(frames_ + 1, novelties_.size());
  newest_ = newest_ + 1 < novelties_.size() ? newest_ + 1 : 0;
  novelties_[newest_] = static_cast<float>(novelty);
  changes_[newest_] = static_cast<float>(change);
}

std::size_t BeliefTraces::trace(std::size_t index, std::span<Step> out) const noexcept {
  const std::size_t held = std::min(frames_, out.size());
  std::size_t back = 0;
  std::size_t frame = newest_;
  auto at = static_cast<Index>(index);
  while (back < held && at != none) {
    const Traced& step = steps_[frame * width_ + at];
    if (step.row == gone<std::uint32_t>) break;
    out[back++] = {.row = step.row,
                   .gain = static_cast<double>(step.gain),
                   .novelty = static_cast<double>(novelties_[frame]),
                   .change = static_cast<double>(changes_[frame]),
                   .in_step = static_cast<double>(step.in_step),
                   .shown = step.shown};
    at = parents_[frame * width_ + at];
    frame = before(frame);
  }
  return back;
}

std::optional<std::size_t> BeliefTraces::row_before(Index index,
                                                    std::size_t frames) const noexcept {
  if (frames >= frames_) return std::nullopt;
  std::size_t frame = newest_;
  for (; frames > 0 && index != none; --frames) {
    index = parents_[frame * width_ + index];
    frame = before(frame);
  }
  if (index == none) return std::nullopt;
  const std::uint32_t row = steps_[frame * width_ + index].row;
  return row == gone<std::uint32_t> ? std::nullopt : std::optional<std::size_t>(row);
}

void BeliefTraces::removed(std::size_t row, bool forgotten) noexcept {
  for (Traced& at : steps_) count_without(row, forgotten, at.row);
}

void BeliefTraces::inserted(std::size_t row) noexcept {
  for (Traced& at : steps_) count_with(row, at.row);
}

}  // namespace seqloop
