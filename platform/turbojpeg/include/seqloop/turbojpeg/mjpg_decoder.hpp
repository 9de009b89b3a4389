// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/picture_decoder.hpp"
#include "seqloop/picture_needs.hpp"

namespace seqloop::turbojpeg {

/// Decodes the JPEG pictures of a camera or a motion JPEG video, no further than needed: grey from
/// the luma alone (full range), and at the smallest of 1/8, 1/4, 1/2 and 1/1 of the size that is as
/// large as needed both ways. A reduced picture is not quite the averaged whole: at just the
/// descriptor's size, the built-in one of Gardens Point's frames moves by 0.06 (day) and 0.09
/// (night) on average, where neighbouring frames are 0.46 apart.
///
/// A frame without Huffman tables, as many cameras send them, has the standard ones. Nothing is
/// kept from frame to frame: the same bytes give the same picture or fault whatever came before.
///
/// Faults are: bytes that are no whole baseline JPEG picture of one or three components; a size
/// other than was declared; and whatever libjpeg warns of, because it then makes up the
/// rest of the picture, save what is harmless. Damage that leaves valid codes behind cannot be
/// seen. What comes after the picture's end is padding and is not looked at; so are up to 4 bytes
/// just before the end, which some cameras put there.
class MjpgDecoder : public PictureDecoder {
 public:
  explicit MjpgDecoder(const PictureNeeds& needs);
  MjpgDecoder(const MjpgDecoder&) = delete;
  MjpgDecoder& operator=(const MjpgDecoder&) = delete;
  MjpgDecoder(MjpgDecoder&&) = delete;
  MjpgDecoder& operator=(MjpgDecoder&&) = delete;
  ~MjpgDecoder() override;

  /// @param raw `mjpg`; its width and height are those that were declared
  /// @param image grey or BGR, `needs` says which. Its own memory, taken when the size is new
  /// Work: at most that of the size declared. Allocates: libjpeg does, in chunks whose number does
  /// not depend on the size, and frees it all.
  [[nodiscard]] std::string_view decode(const RawPicture& raw, Image& image) noexcept override;

  /// Whether the last picture was refused because its size is another than was declared.
  [[nodiscard]] bool is_of_another_size() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::turbojpeg
