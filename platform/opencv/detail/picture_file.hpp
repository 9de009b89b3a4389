// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop::opencv {

/// What can be seen of a picture file from outside. Formats other than JPEG, PNG, PGM and PPM are
/// left to the decoder.
struct PictureFile {
  /// Empty, or a JPEG or PNG that was cut off (decoders make a half grey picture of those) or that
  /// has more pixels than a camera or more scans than an encoder writes; no text when nothing was
  /// found.
  std::string_view fault;
  std::uint64_t width = 0;   ///< pixels, before it is turned; 0: not seen
  std::uint64_t height = 0;  ///< likewise
  bool jpeg = false;
  int components = 0;       ///< of a JPEG: 1 grey, 3 colours, 4 inks; 0: not seen
  std::uint64_t white = 0;  ///< the value of white, of a PGM or PPM; 0: not seen
  int orientation = 1;      ///< EXIF's, of a JPEG: 1 upright, 2 to 8 to be turned or mirrored
};

/// Allocates: never.
[[nodiscard]] PictureFile look_at(std::span<const std::uint8_t> file) noexcept;

}  // namespace seqloop::opencv
