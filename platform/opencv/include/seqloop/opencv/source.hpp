// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "seqloop/frame_source.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::opencv {

struct SourceOptions {
  bool gray = false;                ///< grey pictures are enough
  double frames_per_second = 10.0;  ///< of image folders, > 0; a video brings its own times
  std::unique_ptr<PictureDecoder> jpeg = {};  ///< of image folders, see ImageFolderSource
  std::unique_ptr<PictureDecoder> mjpg = {};  ///< of videos, see VideoSource
};

/// Opens an image folder or a video file, whichever the path is.
/// Throws SetupError as the sources do, and for a device, a pipe and a single picture.
[[nodiscard]] std::unique_ptr<FrameSource> open_source(const std::filesystem::path& path,
                                                       SourceOptions options = {});

}  // namespace seqloop::opencv
