// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "seqloop/raw_picture.hpp"

namespace seqloop::live {

/// One way in which a camera can be run.
struct CameraMode {
  std::uint32_t fourcc = 0;  ///< V4L2's own name of the format
  RawFormat format = RawFormat::gray8;
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  // Seconds from one frame to the next, as the driver writes them; 0/0 where it does not say.
  std::uint32_t interval_numerator = 0;
  std::uint32_t interval_denominator = 0;

  bool operator==(const CameraMode&) const = default;
};

/// Frames a second; 0 where the driver does not say.
[[nodiscard]] double rate(const CameraMode& mode) noexcept;

/// `YUYV 640x480 at 30 fps`.
[[nodiscard]] std::string to_string(const CameraMode& mode);

/// What frames are wanted for.
struct CameraWish {
  int least_width = 0;   ///< pixels that the descriptor takes in; 0: any
  int least_height = 0;  ///< likewise
  bool colour = false;   ///< colour is needed; else grey is enough
  double rate = 10.0;    ///< frames a second, at least

  // What the user insists on.
  std::optional<RawFormat> format = {};
  std::optional<std::pair<int, int>> size = {};  ///< width, height
};

/// Everything that a camera offers.
struct CameraOffer {
  std::vector<CameraMode> modes;           ///< those that can be read
  std::vector<std::string> other_formats;  ///< those that cannot, `H264 (H.264)`
  std::vector<std::string> ranges;         ///< sizes or rates that are not a list, for a person
};

}  // namespace seqloop::live
