// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dds/stamps.hpp"
#include "seqloop/clock.hpp"

namespace seqloop::dds {

/// What the stamps in the headers of pictures say: when each was taken, and how many are missing
/// before it. DDS itself does not tell what was lost where nothing is sent again.
class FrameTimes {
 public:
  struct Judged {
    Nanoseconds stamp{0};     ///< when it was taken, on the clock of arrivals; never after arrival
    double time_s = 0.0;      ///< since the first, never going back
    std::uint64_t lost = 0;   ///< that the camera must have made since the one before
    std::string_view remark;  ///< what is odd; empty when nothing is, or it was told lately
  };

  /// @param stamp_ns of the header, since 1970; 0: none   @param arrived on a clock that never
  /// jumps   @param wall_ns since 1970, at that time
  /// Allocates: never.
  [[nodiscard]] Judged judge(std::int64_t stamp_ns, Nanoseconds arrived,
                             std::int64_t wall_ns) noexcept;

  /// What a header said, or would have, at second 0, in nanoseconds since 1970.
  [[nodiscard]] std::int64_t start_ns() const noexcept { return start_ns_; }

  /// What the headers said at a time, or would have: also before they went back. Any thread may
  /// ask. @param time_ns since second 0   @return 0 where nobody knows any more
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t time_ns) const noexcept {
    return stamps_.at(time_ns);
  }

 private:
  enum class Odd : std::uint8_t { none, no_stamp, went_back, other_clock };

  void begin_at(std::int64_t start_ns) noexcept;
  [[nodiscard]] double usual_interval() const noexcept;
  [[nodiscard]] std::uint64_t missing(std::int64_t interval) noexcept;
  [[nodiscard]] std::string_view tell(Odd odd) noexcept;

  std::uint64_t frames_ = 0;
  std::int64_t start_ns_ = 0;
  Stamps stamps_;
  std::int64_t last_ns_ = 0;     // since second 0
  std::int64_t last_stamp_ = 0;  // of the header
  Nanoseconds last_arrived_{0};
  std::array<std::int64_t, 9> intervals_{};  // the newest, in a ring
  std::size_t known_ = 0;
  std::array<std::uint64_t, 4> told_{};  // frames at which each oddity was told last, from 1
};

}  // namespace seqloop::dds
