// SPDX-License-Identifier: MIT
#include "program/run/trouble_log.hpp"
#include "seqloop/detail/counted.hpp"

#include <fmt/format.h>

#include <utility>

namespace seqloop::program {
namespace {

constexpr Nanoseconds tell_again_after = std::chrono::minutes(1);

double seconds(Nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

void TroubleLog::tell(const ProcessedFrame& processed, Nanoseconds now) {
  if (processed.report.gate == Gate::no_frame) {
    tell_silence(processed, now);
    return;
  }
  if (silent_since_) {
    progress_->tell(fmt::format("frame {}: frames come again after {:.1f} s",
                                processed.report.newest, seconds(silence(now))));
    silent_since_.reset();
  }
  if (!processed.frame.remark.empty()) {
    progress_->tell(fmt::format("frame {}: {}", processed.report.newest, processed.frame.remark));
  }
  if (!processed.fault.empty()) tell_error(processed, now);
}

void TroubleLog::tell_silence(const ProcessedFrame& processed, Nanoseconds now) {
  if (silent_since_ && now - told_ < tell_again_after) return;
  if (!silent_since_) silent_since_ = now;
  told_ = now;
  progress_->tell(processed.fault);
}

void TroubleLog::tell_error(const ProcessedFrame& processed, Nanoseconds now) {
  if (!live_) {
    progress_->tell_fault(fmt::format("frame {}", processed.report.newest), processed.report.newest,
                          processed.fault);
    return;
  }
  if (error_told_ && now - *error_told_ < tell_again_after) {
    ++errors_untold_;
    return;
  }
  error_told_ = now;
  const std::uint64_t untold = std::exchange(errors_untold_, 0);
  progress_->tell(
      fmt::format("frame {}: {}{}", processed.report.newest, processed.fault,
                  untold > 0 ? fmt::format(" ({} more since the last word)", untold) : ""));
}

void TroubleLog::tell(const OverloadWatch& watch, const OverloadRule& rule) {
  if (!watch.overloaded()) {
    progress_->tell(fmt::format("within the budget for {}: back to every frame",
                                counted(rule.recover, "frame")));
  } else if (rule.policy == OverloadPolicy::every_nth) {
    progress_->tell(fmt::format("{} in a row over the budget: taking one frame of {}",
                                counted(rule.after, "frame"), rule.every));
  } else {
    progress_->tell(counted(rule.after, "frame") +
                    " in a row over the budget: dropping the oldest frames");
  }
}

}  // namespace seqloop::program
