// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "seqloop/frame.hpp"

namespace seqloop::opencv {

/// Brings pictures to one size and, where asked, to grey, in memory that it keeps.
class PictureResizer {
 public:
  /// @param width, height pixels, >= 1; both 0: every picture keeps its size
  PictureResizer(int width, int height, bool gray);
  PictureResizer(const PictureResizer&) = delete;
  PictureResizer& operator=(const PictureResizer&) = delete;
  PictureResizer(PictureResizer&&) = delete;
  PictureResizer& operator=(PictureResizer&&) = delete;
  ~PictureResizer();

  /// Colour becomes grey first; then the size shrinks by averaging (INTER_AREA) or grows linearly.
  /// @param picture not empty
  /// @return valid until the next call: the picture itself where nothing has to change; empty when
  /// OpenCV could not do it, which means that memory ran out. Allocates: when the size changes.
  [[nodiscard]] Image resize(const Image& picture) noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
