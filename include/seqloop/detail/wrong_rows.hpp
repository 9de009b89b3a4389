// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "seqloop/detail/kept_row.hpp"

namespace seqloop {

/// How well the best wrong rows of a drive do, learnt as it goes. Which rows are wrong is guessed
/// when a frame comes, and known better some frames later: what was learnt of the newest frames is
/// a guess that is made anew. Source: src/README.md, section 6.4.
class WrongRows {
 public:
  /// Frames after which a guess is replaced.
  static constexpr std::size_t lag = 20;

  /// The best wrong sum where no row is known.
  static constexpr double least = -2.0;

  /// A row of a frame, and what it had gained while it was wrong.
  struct Row {
    std::size_t row;
    double sum;
  };
  struct Frame {
    std::optional<Row> likeliest;
    std::optional<Row> other;  ///< the best of the rows elsewhere
    bool on_map = false;       ///< whether the likeliest row was taken for right
    double novelty = 0.0;  ///< 0 .. 1; nothing is learnt from a frame that tells hardly anything
  };

  /// Takes the newest frame.
  void take(const Frame& frame) noexcept;

  /// The frame that came `lag` frames before the one that is taken next; none: there is none.
  [[nodiscard]] Frame* due() noexcept {
    return count_ == lag ? &frames_[(newest_ + 1) % lag] : nullptr;
  }

  /// No frame will be known better than it is.
  void settle() noexcept;

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept {
    for_each_row([row](std::size_t& at) { count_without(row, false, at); });
  }

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept {
    for_each_row([row](std::size_t& at) { count_with(row, at); });
  }

  /// How far a sum lies above the best wrong ones, in their deviations.
  [[nodiscard]] double lead(double sum) const noexcept;

  [[nodiscard]] double mean() const noexcept { return now_.mean; }

  /// The mean novelty of the frames that were learnt from, 0 .. 1.
  [[nodiscard]] double novelty() const noexcept { return now_.novelty; }

 private:
  /// Running means and a variance.
  struct Level {
    double mean = 0.0;
    double variance = 1.0;
    double novelty = 1.0;
    double weight = 0.0;

    void learn(const Frame& frame) noexcept;
  };

  template <class Change>
  void for_each_row(Change change) noexcept {
    for (Frame& frame : frames_) {
      if (frame.likeliest) change(frame.likeliest->row);
      if (frame.other) change(frame.other->row);
    }
  }

  Level known_;                      // of the frames before those below
  Level now_;                        // with the guesses
  std::array<Frame, lag> frames_{};  // a ring
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
};

}  // namespace seqloop
