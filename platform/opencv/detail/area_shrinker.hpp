// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace seqloop::opencv {

/// Shrinks grey pictures by averaging what each new pixel covers, as OpenCV's INTER_AREA does, but
/// in whole numbers, and without a pass over floats where the sizes are no multiples of each other:
/// 640x480 → 128x64 in 51 us, not 348. Memory is kept from picture to picture.
class AreaShrinker {
 public:
  /// @param picture CV_8UC1, as wide and as high as `size` at least; up to 2^31 pixels
  /// @param shrunk made CV_8UC1 of that size; halves are rounded up
  /// Work: an addition a pixel, and a multiplication more at the borders of what is averaged.
  /// Allocates: when a size changes. May throw cv::Exception, std::bad_alloc.
  void shrink(const cv::Mat& picture, const cv::Size& size, cv::Mat& shrunk);

 private:
  /// What one new pixel covers of a line of old ones. Weights are in parts of an old pixel, of
  /// which there are as many as new pixels.
  struct Cover {
    int first;                  ///< old pixel, covered in part
    int whole;                  ///< pixels behind it that are covered whole
    std::uint32_t first_part;   ///< weight of the first
    std::uint32_t behind_part;  ///< weight of the one behind those, 0 where there is none
  };

  static void cover(int old_size, int new_size, std::vector<Cover>& covers);
  void add_rows(const cv::Mat& picture, const Cover& rows, std::uint32_t weight);

  cv::Size from_;
  cv::Size to_;
  std::vector<Cover> across_;        ///< [new width]
  std::vector<Cover> down_;          ///< [new height]
  std::vector<std::uint16_t> rows_;  ///< [old width] sums of whole rows
  std::vector<std::uint32_t> sums_;  ///< [old width] weighted sums of the rows of one new row
};

}  // namespace seqloop::opencv
