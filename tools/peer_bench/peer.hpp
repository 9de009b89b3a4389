// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/frame.hpp"

namespace seqloop::peers {

/// What a peer says of a frame, before anything is accepted.
struct Guess {
  std::optional<std::size_t> place;  ///< a frame of the map, or an earlier one of the drive
  /// How far away that is; of words, how unlike, 0 to 1. Lower is better.
  double distance = std::numeric_limits<double>::infinity();
  /// That by the distance of the best place which is more than ten frames from it. 0 to 1.
  double ratio = 1.0;
  std::size_t inliers = 0;  ///< features that agree with one fundamental matrix
};

/// Another way to find places again: single frames, looked up one by one.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  Peer(Peer&&) = delete;
  Peer& operator=(Peer&&) = delete;
  virtual ~Peer() = default;

  /// Shown the map beforehand or, where there is none, the drive itself: an advantage over us.
  virtual void learn(const Frame& frame) = 0;
  /// The map, or that drive, is over.
  virtual void learnt() = 0;

  /// Takes up the next frame: of the map first, then of the drive.
  virtual void see(const Frame& frame) = 0;
  /// Looks among the places for the frame that was seen last.
  [[nodiscard]] virtual Guess find() = 0;
  /// Makes it a place. Places are numbered from 0.
  virtual void keep() = 0;
  /// The map is over: the drive begins.
  virtual void begin() = 0;
};

/// FAISS on descriptors. @param graph HNSW with 32 links; else every place is looked at
/// @param closing whether the drive itself is the map @param exclude frames before it becomes one
[[nodiscard]] std::unique_ptr<Peer> nearest_neighbour(bool graph, bool standardise, bool closing,
                                                      std::size_t exclude);

/// ORB features as words, an inverted index, islands of neighbours, and a fundamental matrix.
[[nodiscard]] std::unique_ptr<Peer> bag_of_words(std::size_t exclude);

}  // namespace seqloop::peers
