// SPDX-License-Identifier: MIT
#include "peer_bench/vocabulary.hpp"

#include <algorithm>
#include <functional>

namespace seqloop::peers {
namespace {

constexpr std::size_t branches = 10;
constexpr int levels = 4;
constexpr int rounds = 5;

/// The first of the nearest. @param centre that an item has
template <class Item, class Centre>
std::size_t nearest(std::span<const Item> items, const Bits& feature, Centre centre) noexcept {
  const auto distance = [&](const Item& item) {
    return differing(std::invoke(centre, item), feature);
  };
  return static_cast<std::size_t>(std::ranges::min_element(items, {}, distance) - items.begin());
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
    for (const Bits& feature : features)
      parts[nearest(std::span<const Bits>(centres), feature, std::identity())].push_back(feature);
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
    const auto children = std::span(nodes_).subspan(nodes_[node].first, nodes_[node].count);
    node = nodes_[node].first + nearest(children, feature, &Node::centre);
  }
  return nodes_[node].word;
}

}  // namespace seqloop::peers
