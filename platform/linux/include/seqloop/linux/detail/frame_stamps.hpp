// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "seqloop/clock.hpp"

namespace seqloop::live {

/// What can be odd about the time stamp that a driver gives a frame.
enum class OddStamp : std::uint8_t {
  none,
  other_clock,    ///< it is on a clock that cannot be compared with ours
  went_back,      ///< before the frame before it
  stood_still,    ///< the same as of the frame before it
  in_the_future,  ///< more than 5 ms after the frame arrived
  too_old         ///< more than 30 s before the frame arrived
};
inline constexpr std::size_t odd_stamp_kinds = 6;  ///< with `none`

/// What it is, in words.
[[nodiscard]] std::string_view to_string(OddStamp odd) noexcept;

/// Makes moments that can be relied on out of a driver's time stamps: on this program's clock,
/// never after the frame arrived, never going back. Where a stamp is odd, the moment of arrival
/// stands for it, and for those that follow until they lie after it. Pure: no clock, no memory but
/// its own.
class FrameStamps {
 public:
  struct Judged {
    Nanoseconds stamp{0};  ///< at most `arrived`, at least that of the frame before
    OddStamp odd = OddStamp::none;
    bool tell = false;  ///< the oddity is new: it was not there in the 300 frames before
  };

  /// @param arrived never before that of the frame before
  [[nodiscard]] Judged judge(Nanoseconds stamp, bool monotonic, Nanoseconds arrived) noexcept;

  /// How often each oddity came.
  [[nodiscard]] std::uint64_t count(OddStamp odd) const noexcept {
    return counts_[static_cast<std::size_t>(odd)];
  }

 private:
  [[nodiscard]] OddStamp oddity(Nanoseconds stamp, bool monotonic,
                                Nanoseconds arrived) const noexcept;

  std::array<std::uint64_t, odd_stamp_kinds> counts_{};
  std::array<std::uint64_t, odd_stamp_kinds> last_seen_{};  // frame number; 0: never
  std::uint64_t frames_ = 0;
  Nanoseconds last_driver_{0};
  Nanoseconds last_{0};
};

}  // namespace seqloop::live
