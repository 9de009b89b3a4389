// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "program/process/progress.hpp"
#include "seqloop/budget.hpp"

namespace seqloop::program {

/// Tells on stderr what goes wrong, frame by frame. Of a live source, only when it begins, now and
/// then, and when it is over: a camera may be gone for days.
class TroubleLog {
 public:
  /// @param progress lives longer
  TroubleLog(Progress& progress, bool live) : progress_(&progress), live_(live) {}

  /// @param now time on the run's clock
  void tell(const ProcessedFrame& processed, Nanoseconds now);

  /// What the overload policy does from here on.
  void tell(const OverloadWatch& watch, const OverloadRule& rule);

  /// How long no frame has come; zero while they come.
  [[nodiscard]] Nanoseconds silence(Nanoseconds now) const noexcept {
    return silent_since_ ? now - *silent_since_ : Nanoseconds(0);
  }

 private:
  void tell_silence(const ProcessedFrame& processed, Nanoseconds now);
  void tell_error(const ProcessedFrame& processed, Nanoseconds now);

  Progress* progress_;
  bool live_;
  std::optional<Nanoseconds> silent_since_;
  Nanoseconds told_{0};
  std::optional<Nanoseconds> error_told_;
  std::uint64_t errors_untold_ = 0;
};

}  // namespace seqloop::program
