// SPDX-License-Identifier: MIT
#include "seqloop/detail/belief_traces.hpp"

#include <algorithm>

namespace seqloop {

BeliefTraces::BeliefTraces(Arena& arena, std::size_t depth, std::size_t width)
    : width_(width),
      steps_(arena.take<Traced>("traces of hypotheses", depth * width)),
      novelties_(arena.take<float>("novelties of frames", depth)) {}

void BeliefTraces::next(double novelty) noexcept {
  ++frames_;
  novelties_[slot(0)] = static_cast<float>(novelty);
}

void BeliefTraces::set(std::size_t index, std::size_t row, std::uint32_t parent,
                       double gain) noexcept {
  steps_[slot(0) * width_ + index] = {static_cast<std::uint32_t>(row), parent,
                                      static_cast<float>(gain)};
}

std::size_t BeliefTraces::trace(std::size_t index, std::span<Step> out) const noexcept {
  const std::size_t held =
      static_cast<std::size_t>(std::min<std::uint64_t>({frames_, novelties_.size(), out.size()}));
  std::size_t back = 0;
  std::size_t frame = held > 0 ? slot(0) : 0;
  auto at = static_cast<std::uint32_t>(index);
  while (back < held && at != none) {
    const Traced& step = steps_[frame * width_ + at];
    out[back++] = {step.row, static_cast<double>(step.gain),
                   static_cast<double>(novelties_[frame])};
    at = step.parent;
    frame = (frame == 0 ? novelties_.size() : frame) - 1;
  }
  return back;
}

void BeliefTraces::removed(std::size_t row) noexcept {
  for (Traced& at : steps_) {
    if (at.row > row) --at.row;
  }
}

void BeliefTraces::inserted(std::size_t row) noexcept {
  for (Traced& at : steps_) {
    if (at.row >= row) ++at.row;
  }
}

}  // namespace seqloop
