// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/usual.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {

/// Which frames of a drive are keyframes: those that sequences are made of. A frame that shows
/// hardly anything new beside what usually is new is none: the robot stands. So it does where much
/// is new, but no more than since long ago: that is noise. Where frames follow
/// each other so closely that the scene hardly changes from one to the next, only those are that
/// look unlike the last one. A drive that closes loops keeps to that once it was so: its places
/// were taken so. So a faster camera, a slower robot and one that stands show the same sequence.
/// Source: src/README.md, section 5.11.
class Keyframes {
 public:
  /// A change is usually taken to be so many frames from the last one at most.
  static constexpr std::uint64_t most_apart = 4;

  /// Frames that may become steps late at most: two windows of keyframes, of which nothing was
  /// seen.
  [[nodiscard]] static constexpr std::size_t most_held_back(std::size_t sequence_length) noexcept {
    return 2 * most_apart * (sequence_length + 1);
  }

  /// Allocates: from the arena only, 12 bytes a feature.
  Keyframes(Arena& arena, std::size_t descriptor_size)
      : last_(arena.take<float>("last keyframe", descriptor_size)),
        last_change_(arena.take<float>("last frame that looked new", descriptor_size)),
        earlier_(arena.take<float>("keyframe of some time ago", descriptor_size)) {}

  /// Another drive begins, of which nothing is known.
  void begin() noexcept {
    usually_apart_ = Usual(apart_at_first, changes_at_first);
    changes_ = 0;
    is_dense_ = false;
    since_change_ = 0;
    hidden_ = 0;
    usually_new_ = Usual(new_at_first);
    since_cut_ = settled_after;
    keyframes_ = 0;
    since_earlier_ = renewed_after;
    still_in_a_row_ = 0;
    std::ranges::fill(last_change_, 0.0F);
    last_is_change_ = true;
  }

  /// It is matched with a map. @param spacing how unlike neighbours among its places usually are: 1
  /// is as unlike as two that have nothing to do with each other
  void go_by(double spacing) noexcept {
    constexpr double share = 0.5;
    change_ = change_where_dense_ = share * spacing;
    has_map_ = true;
  }

  /// Takes the next frame. @param variance of all features together
  /// @return whether it is a keyframe
  /// Work: 3 D. Allocates: never.
  bool take(std::span<const float> descriptor, double variance) noexcept {
    const double unrelated = 2.0 * variance;
    const bool was_dense = is_dense_;
    if (was_dense) still_in_a_row_ = 0;
    const double from_change = squared_distance(last_change_, descriptor);
    const double differs = last_is_change_ ? from_change : squared_distance(last_, descriptor);
    const bool changed = take_change(from_change, unrelated);
    const bool is_keyframe = was_dense ? changed
                                       : differs > stands * usually_new_.mean() * unrelated &&
                                             !shows_only_noise(descriptor, differs, unrelated);
    keep(descriptor, changed, is_keyframe);
    if (!is_keyframe) return false;
    const double is_new = std::min(differs, unrelated);
    if (unrelated > 0.0) usually_new_.take(is_new / unrelated);
    since_cut_ = is_new < cut * unrelated ? since_cut_ + 1 : 0;
    ++keyframes_;
    if (++since_earlier_ >= renewed_after) {
      since_earlier_ = 0;
      std::ranges::copy(descriptor, earlier_.begin());
    }
    return true;
  }

  /// Whether the scene has not changed as a whole lately, as it does when the robot is carried
  /// away.
  [[nodiscard]] bool is_settled() const noexcept { return since_cut_ >= settled_after; }

  /// Whether it changed so from the keyframe before the newest one to that.
  [[nodiscard]] bool is_cut() const noexcept { return since_cut_ == 0; }

  /// Frames that never came, or cannot be read. Where the next one that does still looks like the
  /// last change, they did so, too; else the scene changed with one of them, or with that one.
  /// @return how many keyframes they are by what is usual, of several calls on end together
  [[nodiscard]] std::uint64_t skip(std::uint64_t frames) noexcept {
    const std::uint64_t before = std::exchange(hidden_, hidden_ + frames);
    if (!is_dense_) return frames;
    const auto keyframes = [apart = usually_apart_.mean()](std::uint64_t hidden) {
      return static_cast<std::uint64_t>(static_cast<double>(hidden) / apart);
    };
    return keyframes(hidden_) - keyframes(before);
  }

  /// Whether it usually takes more than a frame for the scene to change.
  [[nodiscard]] bool is_dense() const noexcept { return is_dense_; }

 private:
  /// Whether the last frames were all as unlike the last keyframe as one of some time ago. A robot
  /// that drives on looks ever less like that. @param differs squared distance of the last one
  /// @param unrelated of two frames that have nothing to do with each other
  bool shows_only_noise(std::span<const float> descriptor, double differs,
                        double unrelated) noexcept {
    const bool some_time_ago = keyframes_ >= before_noise_is_known && since_earlier_ >= some_time &&
                               since_earlier_ < renewed_after;
    const double alike = unrelated - differs;
    const bool still = some_time_ago && differs < by_chance * unrelated &&
                       unrelated - squared_distance(earlier_, descriptor) >= as_alike * alike &&
                       (still_in_a_row_ == 0 || alike >= goes_on * usually_alike_);
    still_in_a_row_ = still ? still_in_a_row_ + 1 : 0;
    if (still) usually_alike_ += (alike - usually_alike_) / static_cast<double>(still_in_a_row_);
    return still_in_a_row_ >= in_a_row;
  }

  /// Whether a frame looks unlike the last that did. @param differs squared distance of the two
  /// @param unrelated of two frames that have nothing to do with each other
  bool take_change(double differs, double unrelated) noexcept {
    const double change = is_dense_ ? change_where_dense_ : change_;
    const std::uint64_t hidden = std::exchange(hidden_, 0);
    if (differs <= change * unrelated) {
      since_change_ += hidden + 1;
      return false;
    }
    // A robot that stands says nothing of how fast it goes.
    const auto apart = [](std::uint64_t frames) {
      return static_cast<double>(std::min(frames, most_apart));
    };
    // Dense is what is seen to be; then it took as many as usual, if that may be.
    usually_apart_.take(std::clamp(is_dense_ ? usually_apart_.mean() : 1.0,
                                   apart(since_change_ + 1), apart(since_change_ + hidden + 1)));
    ++changes_;
    since_change_ = 0;
    decide();
    return true;
  }

  /// A drive that becomes dense late has places that were sampled otherwise, so that is left to
  /// those that clearly are.
  void decide() noexcept {
    const double apart = usually_apart_.mean();
    if (has_map_) {
      is_dense_ = apart > dense_with_map;
    } else if (changes_ <= first_changes) {
      is_dense_ = apart > dense_at_first;
    } else {
      is_dense_ = is_dense_ || apart > dense_later;
    }
  }

  /// A frame that is both is kept once, and so compared once with the next: mostly all are.
  void keep(std::span<const float> descriptor, bool changed, bool is_keyframe) noexcept {
    if (changed && is_keyframe) {
      std::ranges::copy(descriptor, last_change_.begin());
      last_is_change_ = true;
      return;
    }
    if (!changed && !is_keyframe) return;
    if (last_is_change_ && changed) std::ranges::copy(last_change_, last_.begin());
    last_is_change_ = false;
    std::ranges::copy(descriptor, (changed ? last_change_ : last_).begin());
  }

  // Less than this share of what is usually new is nothing.
  static constexpr double stands = 0.15;
  // Noise is what is new since so many keyframes ago, too, until so many; so much alike, at so many
  // frames in a row.
  static constexpr std::uint64_t some_time = 8;
  static constexpr std::uint64_t renewed_after = 17;
  static constexpr double as_alike = 0.95;
  static constexpr std::uint64_t in_a_row = 6;
  static constexpr double goes_on = 0.85;  // with less of what was alike in that row
  // What all frames show alike is not standardised yet in the first ones.
  static constexpr std::uint64_t before_noise_is_known = 40;
  // What differs by more of what unrelated frames do may be alike by chance.
  static constexpr double by_chance = 0.6;
  static constexpr double apart_at_first = 1.0;
  static constexpr double changes_at_first = 5.0;  // as if seen
  static constexpr double new_at_first = 0.1;
  // So new is a cut, and so many keyframes later it is known whether the robot knows the place.
  static constexpr double cut = 0.5;
  static constexpr std::uint64_t settled_after = 8;

  // Frames from one change to the next where a drive is dense.
  static constexpr double dense_with_map = 1.9;
  static constexpr double dense_at_first = 1.8;
  static constexpr double dense_later = 2.2;
  static constexpr std::uint64_t first_changes = 40;

  // New is by what two frames that have nothing in common differ by.
  double change_ = 0.1;                // so new is a change
  double change_where_dense_ = 0.125;  // likewise
  bool has_map_ = false;               // is matched with
  bool is_dense_ = false;
  std::uint64_t changes_ = 0;
  std::uint64_t since_change_ = 0;  // frames up to the last one that still looked like it
  std::uint64_t hidden_ = 0;        // since then
  Usual usually_apart_{apart_at_first, changes_at_first};  // frames from one change to the next
  Usual usually_new_{new_at_first};          // so new is a keyframe beside the one before it
  std::uint64_t since_cut_ = settled_after;  // keyframes
  std::uint64_t keyframes_ = 0;
  std::uint64_t since_earlier_ = renewed_after;  // keyframes
  double usually_alike_ = 0.0;                   // in the row below
  std::uint64_t still_in_a_row_ = 0;             // frames
  bool last_is_change_ = true;    // then the last keyframe is kept as the last change
  std::span<float> last_;         // [D]
  std::span<float> last_change_;  // [D]
  std::span<float> earlier_;      // [D]
};

}  // namespace seqloop
