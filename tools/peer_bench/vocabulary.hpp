// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace seqloop::peers {

/// An ORB descriptor.
using Bits = std::array<std::uint64_t, 4>;

inline unsigned differing(const Bits& a, const Bits& b) noexcept {
  unsigned sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += static_cast<unsigned>(std::popcount(a[i] ^ b[i]));
  return sum;
}

/// A tree of binary words, as DBoW2 grows it: each node parts what reaches it into ten by
/// k-medians, four times.
class Vocabulary {
 public:
  /// @param features all that it is learnt from; reordered. Work: 40 n a round.
  void learn(std::vector<Bits>& features);

  /// The word of a feature. Work: 40 comparisons.
  [[nodiscard]] std::size_t word(const Bits& feature) const noexcept;

  [[nodiscard]] std::size_t words() const noexcept { return words_; }

 private:
  struct Node {
    Bits centre{};
    std::size_t first = 0;  // child
    std::size_t count = 0;  // children; 0: a word
    std::size_t word = 0;
  };
  void part(std::size_t node, std::span<Bits> features, int levels);

  std::vector<Node> nodes_;
  std::size_t words_ = 0;
};

}  // namespace seqloop::peers
