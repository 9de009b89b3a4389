// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/frame_stamps.hpp"

#include <algorithm>

namespace seqloop::live {
namespace {

constexpr Nanoseconds future_tolerance = std::chrono::milliseconds(5);
constexpr Nanoseconds oldest = std::chrono::seconds(30);
constexpr std::uint64_t quiet_frames = 300;

}  // namespace

std::string_view to_string(OddStamp odd) noexcept {
  switch (odd) {
    case OddStamp::none:
      break;
    case OddStamp::other_clock:
      return "time stamps are on an unknown clock: the time of arrival is used";
    case OddStamp::went_back:
      return "the time stamp went back: the time of arrival is used";
    case OddStamp::stood_still:
      return "the time stamp stood still: the time of arrival is used";
    case OddStamp::in_the_future:
      return "the time stamp lies in the future: the time of arrival is used";
    case OddStamp::too_old:
      return "the time stamp is more than 30 s old: the time of arrival is used";
  }
  return {};
}

OddStamp FrameStamps::oddity(Nanoseconds stamp, bool monotonic,
                             Nanoseconds arrived) const noexcept {
  if (!monotonic) return OddStamp::other_clock;
  if (stamp > arrived + future_tolerance) return OddStamp::in_the_future;
  if (stamp < arrived - oldest) return OddStamp::too_old;
  if (frames_ <= 1) return OddStamp::none;
  if (stamp == last_driver_) return OddStamp::stood_still;
  return stamp < last_driver_ ? OddStamp::went_back : OddStamp::none;
}

FrameStamps::Judged FrameStamps::judge(Nanoseconds stamp, bool monotonic,
                                       Nanoseconds arrived) noexcept {
  ++frames_;
  Judged judged{std::min(stamp, arrived), oddity(stamp, monotonic, arrived), false};
  // After an odd one, good stamps may lie before what stood for it.
  if (judged.odd != OddStamp::none || judged.stamp < last_) judged.stamp = arrived;
  if (judged.odd != OddStamp::none) {
    const auto kind = static_cast<std::size_t>(judged.odd);
    judged.tell = last_seen_[kind] == 0 || frames_ - last_seen_[kind] > quiet_frames;
    last_seen_[kind] = frames_;
    ++counts_[kind];
  }
  last_driver_ = stamp;
  last_ = judged.stamp;
  return judged;
}

}  // namespace seqloop::live
