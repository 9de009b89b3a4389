// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {

/// Which frames of a drive are keyframes: those that sequences are made of. Where frames follow
/// each other so closely that the scene hardly changes from one to the next, only those are that
/// look unlike the last one; where they do not, all are, but for the later part of a long stop. So
/// a faster camera, a slower robot and one that stands show the same sequence. Source:
/// src/README.md, section 5.11.
class Keyframes {
 public:
  /// A change is usually taken to be so many frames from the last one at most.
  static constexpr std::uint64_t most_apart = 4;

  /// Allocates: from the arena only, 4 bytes a feature.
  Keyframes(Arena& arena, std::size_t descriptor_size)
      : last_(arena.take<float>("last frame that looked new", descriptor_size)) {}

  /// Another drive begins, of which nothing is known.
  void begin() noexcept {
    usually_ = 1.0;
    seen_ = at_first;
    since_change_ = 0;
  }

  /// It is matched with a map. @param spacing how unlike neighbours among its places usually are: 1
  /// is as unlike as two that have nothing to do with each other
  void go_by(double spacing) noexcept {
    constexpr double share = 0.5;
    change_ = change_where_dense_ = share * spacing;
    dense_ = 1.9;
  }

  /// Takes the next frame. @param variance of all features together
  /// @return whether it is a keyframe
  /// Work: D. Allocates: never.
  bool take(std::span<const float> descriptor, double variance) noexcept {
    const std::uint64_t frames = ++since_change_;
    const double change = is_dense() ? change_where_dense_ : change_;
    if (squared_distance(last_, descriptor) < 2.0 * change * variance) {
      return !is_dense() && frames < longest_stop;
    }
    std::ranges::copy(descriptor, last_.begin());
    // A robot that stands says nothing of how fast it goes.
    const double took = static_cast<double>(std::min(frames, most_apart));
    since_change_ = 0;
    seen_ = std::min(seen_ + 1.0, memory);
    usually_ += (took - usually_) / seen_;
    return true;
  }

  /// Frames that never came count as frames that did.
  void skip(std::uint64_t frames) noexcept { since_change_ += frames; }

  /// How many keyframes as many frames are, by what is usual.
  [[nodiscard]] std::uint64_t in(std::uint64_t frames) const noexcept {
    return is_dense() ? static_cast<std::uint64_t>(static_cast<double>(frames) / usually_) : frames;
  }

 private:
  /// Whether it usually takes more than a frame for the scene to change.
  [[nodiscard]] bool is_dense() const noexcept { return usually_ > dense_; }

  // Later frames of a stop are none.
  static constexpr std::uint64_t longest_stop = 52;
  // Changes that what is usual is the mean of: as if so many had been seen already, one a frame.
  static constexpr double at_first = 20.0;
  static constexpr double memory = 200.0;

  double dense_ = 2.0;                // frames from one change to the next
  double change_ = 0.1;               // of what two frames that have nothing in common differ by
  double change_where_dense_ = 0.15;  // likewise
  std::uint64_t since_change_ = 0;
  double usually_ = 1.0;    // frames from one change to the next
  double seen_ = at_first;  // changes that this is the mean of
  std::span<float> last_;   // [D]
};

}  // namespace seqloop
