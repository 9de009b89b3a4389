// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "seqloop/frame_source.hpp"
#include "seqloop/picture_decoder.hpp"

namespace seqloop::opencv {

/// Whether a name ends like a picture that this source reads: jpg jpeg png bmp pgm ppm tif tiff
/// webp, in any case.
[[nodiscard]] bool has_image_extension(const std::filesystem::path& path);

/// A drive as a folder of pictures, in natural order of their names (image2 before image10). Hidden
/// files, other files and folders are left out and reported by `notes`.
///
/// Pictures become 8-bit grey or B, G, R: 16-bit ones are scaled, alpha is dropped, and a JPEG is
/// turned as its EXIF orientation says. One that is broken, empty or cut off is `unreadable`, and
/// so is a damaged JPEG where `jpeg` finds the damage.
class ImageFolderSource : public FrameSource {
 public:
  /// @param gray decode to grey, which is cheaper
  /// @param frames_per_second > 0; frame i is at i / frames_per_second
  /// @param jpeg decodes the bytes of JPEG files (`mjpg`), of any size, to grey or colour as `gray`
  ///   says; without one OpenCV does, which makes up what is damaged and does not tell
  /// Throws SetupError: not there, not a folder, may not be read, without pictures; the frame rate.
  ImageFolderSource(const std::filesystem::path& folder, bool gray, double frames_per_second = 10.0,
                    std::unique_ptr<PictureDecoder> jpeg = nullptr);
  ImageFolderSource(const ImageFolderSource&) = delete;
  ImageFolderSource& operator=(const ImageFolderSource&) = delete;
  ImageFolderSource(ImageFolderSource&&) = delete;
  ImageFolderSource& operator=(ImageFolderSource&&) = delete;
  ~ImageFolderSource() override;

  /// Allocates: the decoder does, and OpenCV's every picture anew. OpenCV's decoders write to
  /// stderr by themselves when they meet damage (libjpeg, libpng); nothing can stop them for one
  /// thread alone.
  [[nodiscard]] Grab grab(Frame& frame) noexcept override;

  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override;

  [[nodiscard]] std::vector<std::string> notes() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
