// SPDX-License-Identifier: MIT
#include "experiment/report/spread.hpp"

#include <algorithm>

namespace seqloop::experiment {

std::vector<double> spread(const std::vector<double>& wanted, double gap, double low, double high) {
  struct Block {
    double sum;
    std::size_t count;
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  };
  // Less the gaps before it, each position only has to be no smaller than the one before.
  const auto gaps = [&](std::size_t i) { return gap * static_cast<double>(i); };
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    blocks.push_back({wanted[i] - gaps(i), 1});
    while (blocks.size() > 1 && blocks.back().mean() < blocks[blocks.size() - 2].mean()) {
      const Block last = blocks.back();
      blocks.pop_back();
      blocks.back().sum += last.sum;
      blocks.back().count += last.count;
    }
  }
  const double room = std::max(low, high - gaps(std::max<std::size_t>(wanted.size(), 1) - 1));
  std::vector<double> positions;
  for (const Block& block : blocks) {
    for (std::size_t i = 0; i < block.count; ++i) {
      positions.push_back(std::clamp(block.mean(), low, room) + gaps(positions.size()));
    }
  }
  return positions;
}

}  // namespace seqloop::experiment
