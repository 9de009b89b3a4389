// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "seqloop/capture_device.hpp"
#include "seqloop/latency_histogram.hpp"
#include "seqloop/linux/camera.hpp"
#include "seqloop/linux/camera_list.hpp"

namespace seqloop::program {

/// What a device offers, for a person to read; many lines.
[[nodiscard]] std::string describe_camera(const live::ListedCamera& camera);

/// Collects what a camera's frames tell of its time.
class FrameTimes {
 public:
  /// @param captured a frame or a bad frame
  void add(const Captured& captured);

  /// Rate, gaps, errors, jitter and age, with what the camera counted; many lines.
  [[nodiscard]] std::string report(const live::CameraOptions& asked, const live::CameraFacts& facts,
                                   const live::CameraCounters& counters) const;

 private:
  LatencyHistogram ages_;               ///< from the time stamp to the arrival
  std::vector<Nanoseconds> intervals_;  ///< between good frames that follow each other
  std::uint64_t frames_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t last_index_ = 0;
  bool seen_ = false;
  bool last_was_good_ = false;
  Nanoseconds first_stamp_{0};
  Nanoseconds last_stamp_{0};
};

}  // namespace seqloop::program
