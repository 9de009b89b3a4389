// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "seqloop/frame_source.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::bags {

/// A drive as a bag: the pictures of one topic (`sensor_msgs/msg/Image`, `CompressedImage`).
///
/// A frame's time is its header's stamp; where the first picture has none, the time at which each
/// was recorded. It never goes back: where stamps stand still or were set back, it goes on as it
/// does in the recording, and from there by the stamps. A picture that cannot be read, and a part
/// of the bag that cannot, are a frame that is `unreadable` each.
class BagSource : public FrameSource {
 public:
  /// @param topic empty: the only one with pictures
  /// @param decoder of raw formats, JPEG (`mjpg`) and PNG, in one; pictures have any size
  /// Throws SetupError: as `open_bag`; no such topic; no pictures in it; several such topics.
  BagSource(const std::filesystem::path& path, const std::string& topic,
            std::unique_ptr<PictureDecoder> decoder);
  BagSource(const BagSource&) = delete;
  BagSource& operator=(const BagSource&) = delete;
  BagSource(BagSource&&) = delete;
  BagSource& operator=(BagSource&&) = delete;
  ~BagSource() override;

  /// Pictures are decoded from where the bag's reader has them. Allocates: decoder and reader do.
  [[nodiscard]] Grab grab(Frame& frame) noexcept override;

  /// Messages of the topic, as the bag declares them.
  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override;

  [[nodiscard]] std::vector<std::string> notes() const override;

  /// When second 0 of the drive was, in nanoseconds since 1970.
  [[nodiscard]] std::int64_t start_ns() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::bags
