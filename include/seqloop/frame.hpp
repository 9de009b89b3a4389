// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/clock.hpp"

namespace seqloop {

enum class PixelFormat : std::uint8_t { gray8, bgr8 };

/// A picture that somebody else owns. Rows may be padded.
struct Image {
  const std::uint8_t* data = nullptr;  ///< first byte of the top row
  int width = 0;                       ///< pixels
  int height = 0;                      ///< pixels
  std::size_t stride = 0;              ///< bytes from one row to the next
  PixelFormat format = PixelFormat::gray8;
};

/// One frame as its source hands it over. Everything it points to stays valid until the next grab.
struct Frame {
  std::uint64_t index = 0;            ///< place in the source, from 0; unreadable frames count
  double time_s = 0.0;                ///< seconds since the first frame, by the source's own clock
  Image image;                        ///< empty when the source hands over descriptors
  std::span<const float> descriptor;  ///< [D], when the source was described before
  std::string_view fault;             ///< why the frame could not be read; empty when it could

  // Of live sources; zero for those that wait to be asked.
  std::uint64_t lost = 0;      ///< frames just before this one that the device never handed over
  std::uint64_t dropped = 0;   ///< frames just before this one that were dropped for newer ones
  std::uint32_t sequence = 0;  ///< the device's own number of the frame
  Nanoseconds age{0};          ///< from when the picture was taken to when it was taken up here
  Nanoseconds waited{0};       ///< how long the grab waited for the frame to come
  std::string_view remark;     ///< what is odd about a frame that is good all the same
};

}  // namespace seqloop
