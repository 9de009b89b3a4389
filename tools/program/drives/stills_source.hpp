// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "seqloop/fault.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::program {

/// From the first moment on and before the second, in seconds of a source's own clock.
struct Interval {
  double from_s;
  double to_s;
};

/// A part of a picture, in pixels.
struct Crop {
  int width = 0;  ///< 0: the whole picture
  int height = 0;
  int x = 0;  ///< of its left column
  int y = 0;  ///< of its top row
};

/// Which frames of a drive are taken, and what of them. Without any setting: all of it.
struct StillsSettings {
  double every_s = 0.0;  ///< >= 0.001: the first frame at or after each multiple; 0: every frame
  double from_s = 0.0;   ///< >= 0
  double to_s = std::numeric_limits<double>::infinity();  ///< > from_s
  std::vector<Interval> leave_out = {};                   ///< tunnels and halts, in any order
  int width = 0;  ///< pixels to resize to before anything is cut out; 0: the picture's own
  int height = 0;
  Crop crop = {};
  bool gray = false;
};

/// Everything that is wrong with the settings, also a crop that does not lie in their size.
[[nodiscard]] Faults validate(const StillsSettings& settings);

/// The stills of a drive as a drive of their own. They are numbered from 0, and keep the time that
/// their source gave them. A frame that cannot be read is a still that cannot be read; so is one
/// that is too small for the crop. Frames of descriptors can be chosen by their time, no more.
///
/// `grab` passes over the frames between two stills, each of which is decoded. Cropping copies
/// nothing. The length is known beforehand only where every frame is taken.
///
/// Throws SetupError: as `validate`, and for a crop that does not lie in the first picture, which
/// is looked at where the size is not set.
[[nodiscard]] std::unique_ptr<FrameSource> make_stills(std::unique_ptr<FrameSource> source,
                                                       StillsSettings settings);

}  // namespace seqloop::program
