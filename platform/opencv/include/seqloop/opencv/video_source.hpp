// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "seqloop/frame_source.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::opencv {

/// A drive as a video file, read by the first of OpenCV's backends that can: FFmpeg, the built-in
/// motion JPEG. The pictures of motion JPEG in an AVI file, as webcams are recorded, can be left to
/// a decoder that does no more than needed.
///
/// Times are the container's own where they rise, else index / frame rate; `notes` says when the
/// file has no frame rate. A file that is broken in the middle ends there, or goes on with damaged
/// pictures, as the backend has it: it tells neither. The decoder tells: a damaged picture, whose
/// missing part is made up, has a `remark`, one that is none is `unreadable`, and the file goes on.
/// When fewer frames came than the file promised, `notes` says so.
class VideoSource : public FrameSource {
 public:
  /// @param gray hand over grey pictures
  /// @param mjpg decodes motion JPEG in AVI files, to a size and colour of its own, unless it can
  /// decode none of the first ten pictures, and the backend can, which `notes` says; null: the
  /// backend does
  /// Throws SetupError: not there, not a file, not a video, no frame in it.
  VideoSource(const std::filesystem::path& file, bool gray,
              std::unique_ptr<PictureDecoder> mjpg = nullptr);
  VideoSource(const VideoSource&) = delete;
  VideoSource& operator=(const VideoSource&) = delete;
  VideoSource(VideoSource&&) = delete;
  VideoSource& operator=(VideoSource&&) = delete;
  ~VideoSource() override;

  /// Allocates: the backend or the decoder does.
  [[nodiscard]] Grab grab(Frame& frame) noexcept override;

  /// As the container declares it, which for some formats is an estimate; nothing where it declares
  /// none.
  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override;

  [[nodiscard]] std::vector<std::string> notes() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
