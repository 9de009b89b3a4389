// SPDX-License-Identifier: MIT
#include "program/drives/known_length.hpp"

#include "seqloop/opencv/video_source.hpp"

namespace seqloop::program {

std::optional<std::uint64_t> known_length(const FrameSource& drive) {
  if (dynamic_cast<const opencv::VideoSource*>(&drive) != nullptr) return {};
  return drive.frame_count();
}

}  // namespace seqloop::program
