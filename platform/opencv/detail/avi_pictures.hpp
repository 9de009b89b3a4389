// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "opencv/detail/avi_header.hpp"

namespace seqloop::opencv {

/// The JPEG pictures of the first video in an AVI file, undecoded: OpenCV decodes each of them
/// whole and in colour, or hands them over without their times.
///
/// The file's index and the lengths of its lists are not looked at, so that a recording that was
/// cut off is read as far as it goes. After a damaged chunk header there may be no further picture.
class AviPictures {
 public:
  /// @param header of that file, whose first video is motion JPEG. A file that cannot be opened has
  /// no pictures.
  AviPictures(const std::filesystem::path& file, const AviHeader& header);

  /// Reads the next picture. @param jpeg its bytes, and as long as it is; left as it is at the end
  /// @return false at the end. May throw std::bad_alloc. Allocates: when a picture is larger than
  /// those before it
  [[nodiscard]] bool next(std::vector<std::uint8_t>& jpeg);

  /// Of the picture that was read last, from 0: moments without a picture, which have empty chunks,
  /// are counted, so that its time is this number of frame times.
  [[nodiscard]] std::uint64_t number() const noexcept { return begun_ - 1; }

  /// Pictures and moments without one so far. A file's header declares both.
  [[nodiscard]] std::uint64_t begun() const noexcept { return begun_; }

 private:
  std::ifstream bytes_;
  std::uint64_t size_ = 0;   ///< of the file, bytes
  std::uint64_t place_ = 0;  ///< of the next chunk
  std::uint64_t begun_ = 0;
  int stream_;  ///< of the video among the file's streams
};

}  // namespace seqloop::opencv
