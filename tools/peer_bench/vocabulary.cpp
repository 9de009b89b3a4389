// SPDX-License-Identifier: MIT
#include "peer_bench/vocabulary.hpp"

#include <algorithm>

namespace seqloop::peers {
namespace {

constexpr std::size_t branches = 10;
constexpr int levels = 4;
constexpr int rounds = 5;

std::size_t nearest(std::span<const Bits> centres, const Bits& feature) noexcept {
  std::size_t best = 0;
  unsigned least = differing(centres[0], feature);
  for (std::size_t i = 1; i < centres.size(); ++i) {
    const unsigned distance = differing(centres[i], feature);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

/// Each bit as most of them have it.
Bits median(std::span<const Bits> features) {
  std::array<std::size_t, 256> set{};
  for (const Bits& feature : features) {
    for (std::size_t bit = 0; bit < set.size(); ++bit) {
      set.at(bit) += (feature.at(bit / 64) >> (bit % 64)) & 1U;
    }
  }
  Bits centre{};
  for (std::size_t bit = 0; bit < set.size(); ++bit) {
    if (2 * set.at(bit) > features.size()) centre.at(bit / 64) |= std::uint64_t{1} << (bit % 64);
  }
  return centre;
}

}  // namespace

void Vocabulary::learn(std::vector<Bits>& features) {
  nodes_.assign(1, {});
  words_ = 0;
  part(0, features, levels);
}

void Vocabulary::part(std::size_t node, std::span<Bits> features, int left) {
  if (left == 0 || features.size() <= branches) {
    nodes_[node].word = words_++;
    return;
  }
  // Evenly spread ones to begin with: the same words on every machine.
  std::vector<Bits> centres;
  for (std::size_t i = 0; i < branches; ++i) {
    centres.push_back(features[i * features.size() / branches]);
  }
  std::vector<std::vector<Bits>> parts;
  for (int round = 0; round < rounds; ++round) {
    parts.assign(branches, {});
    for (const Bits& feature : features) parts[nearest(centres, feature)].push_back(feature);
    for (std::size_t i = 0; i < branches; ++i) {
      if (!parts[i].empty()) centres[i] = median(parts[i]);
    }
  }
  std::erase_if(parts, [](const std::vector<Bits>& some) { return some.empty(); });
  if (parts.size() == 1) {
    nodes_[node].word = words_++;
    return;
  }
  const std::size_t first = nodes_.size();
  nodes_[node].first = first;
  nodes_[node].count = parts.size();
  for (const std::vector<Bits>& some : parts) nodes_.push_back({median(some)});
  for (std::size_t i = 0; i < parts.size(); ++i) part(first + i, parts[i], left - 1);
}

std::size_t Vocabulary::word(const Bits& feature) const noexcept {
  std::size_t node = 0;
  while (nodes_[node].count > 0) {
    std::size_t best = nodes_[node].first;
    unsigned least = differing(nodes_[best].centre, feature);
    for (std::size_t child = best + 1; child < nodes_[node].first + nodes_[node].count; ++child) {
      const unsigned distance = differing(nodes_[child].centre, feature);
      if (distance < least) {
        least = distance;
        best = child;
      }
    }
    node = best;
  }
  return nodes_[node].word;
}

}  // namespace seqloop::peers
