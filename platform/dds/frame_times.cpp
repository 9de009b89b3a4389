// SPDX-License-Identifier: MIT
#include "dds/frame_times.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop::dds {
namespace {

constexpr std::int64_t future_tolerance = 5'000'000;  // nanoseconds
constexpr std::int64_t oldest = 30'000'000'000;
constexpr std::int64_t most_stamp = std::int64_t{1} << 62;  // so that differences fit
constexpr double gap = 1.6;  // intervals from which on a picture is missing
constexpr std::uint64_t most_missing = 1'000'000;
constexpr std::uint64_t quiet_frames = 300;

}  // namespace

FrameTimes::Judged FrameTimes::judge(std::int64_t stamp_ns, Nanoseconds arrived,
                                     std::int64_t wall_ns) noexcept {
  Judged judged;
  Odd odd = Odd::none;
  const bool stamped = stamp_ns > 0 && stamp_ns < most_stamp;
  if (!stamped) odd = Odd::no_stamp;
  const std::int64_t since_last = (arrived - last_arrived_).count();
  if (frames_ == 0) {
    begin_at(stamped ? stamp_ns : wall_ns);
  } else if (stamped && last_stamp_ > 0 && stamp_ns >= last_stamp_) {
    const std::int64_t interval = stamp_ns - last_stamp_;
    last_ns_ = std::min(last_ns_ + interval, most_stamp);
    judged.lost = missing(interval);
  } else {
    // Without a stamp, or with one of a clock that was set back, time goes on as it does here.
    if (stamped && last_stamp_ > 0) odd = Odd::went_back;
    last_ns_ += std::max<std::int64_t>(since_last, 0);
    if (stamped) begin_at(stamp_ns - last_ns_);
  }
  judged.time_s = static_cast<double>(last_ns_) / 1e9;
  judged.stamp = arrived;
  const std::int64_t age = stamped ? wall_ns - stamp_ns : 0;
  if (stamped && age >= -future_tolerance && age <= oldest) {
    judged.stamp -= Nanoseconds(std::max<std::int64_t>(age, 0));
  } else if (stamped && odd == Odd::none) {
    odd = Odd::other_clock;
  }
  last_stamp_ = stamped ? stamp_ns : 0;
  last_arrived_ = arrived;
  ++frames_;
  judged.remark = tell(odd);
  return judged;
}

void FrameTimes::begin_at(std::int64_t start_ns) noexcept {
  start_ns_ = start_ns;
  stamps_.add(last_ns_, start_ns);
}

/// @param interval between two stamps. Once a few are known, a longer one than they are has a gap.
std::uint64_t FrameTimes::missing(std::int64_t interval) noexcept {
  std::uint64_t missing = 0;
  if (known_ >= intervals_.size()) {
    const double usual = usual_interval();
    const double times = usual > 0.0 ? static_cast<double>(interval) / usual : 0.0;
    if (times >= gap) {
      missing = static_cast<std::uint64_t>(
          std::min(std::round(times) - 1.0, static_cast<double>(most_missing)));
    }
  }
  intervals_[known_++ % intervals_.size()] = interval;
  return missing;
}

/// The mean of those that are no gaps themselves.
double FrameTimes::usual_interval() const noexcept {
  std::array<std::int64_t, 9> sorted = intervals_;
  std::ranges::sort(sorted);
  const double most = gap * static_cast<double>(sorted[sorted.size() / 2]);
  double sum = 0.0;
  double count = 0.0;
  for (const std::int64_t interval : sorted) {
    if (static_cast<double>(interval) > most) break;
    sum += static_cast<double>(interval);
    count += 1.0;
  }
  return sum / count;
}

std::string_view FrameTimes::tell(Odd odd) noexcept {
  if (odd == Odd::none) return {};
  std::uint64_t& told = told_[static_cast<std::size_t>(odd)];
  if (told != 0 && frames_ - told <= quiet_frames) return {};
  told = frames_;
  switch (odd) {
    case Odd::no_stamp:
      return "the header has no stamp: the time of arrival is used";
    case Odd::went_back:
      return "the header's stamp went back: the time of arrival is used";
    default:
      return "the header's stamp is of another clock: ages count from arrival";
  }
}

}  // namespace seqloop::dds
