// SPDX-License-Identifier: MIT
#include "opencv/detail/area_shrinker.hpp"

#include <algorithm>
#include <cstddef>

namespace seqloop::opencv {

void AreaShrinker::cover(int old_size, int new_size, std::vector<Cover>& covers) {
  covers.resize(static_cast<std::size_t>(new_size));
  const std::int64_t parts = new_size;  // of an old pixel
  std::int64_t begin = 0;
  for (Cover& cover : covers) {
    const std::int64_t end = begin + old_size;
    const std::int64_t first = begin / parts;
    const std::int64_t first_end = std::min(end, (first + 1) * parts);
    cover = {static_cast<int>(first), static_cast<int>((end - first_end) / parts),
             static_cast<std::uint32_t>(first_end - begin),
             static_cast<std::uint32_t>((end - first_end) % parts)};
    begin = end;
  }
}

/// Sums up the rows of one new row. @param weight of a whole one
void AreaShrinker::add_rows(const cv::Mat& picture, const Cover& rows, std::uint32_t weight) {
  const std::size_t width = sums_.size();
  const auto* first = picture.ptr<std::uint8_t>(rows.first);
  for (std::size_t x = 0; x < width; ++x) sums_[x] = rows.first_part * first[x];
  constexpr int most_at_once = 257;  // of the highest value fit 16 bits
  const int end = rows.first + 1 + rows.whole;
  for (int row = rows.first + 1; row < end;) {
    std::ranges::fill(rows_, std::uint16_t{0});
    std::uint16_t* sums = rows_.data();
    for (const int stop = std::min(end, row + most_at_once); row < stop; ++row) {
      const auto* values = picture.ptr<std::uint8_t>(row);
      for (std::size_t x = 0; x < width; ++x)
        sums[x] = static_cast<std::uint16_t>(sums[x] + values[x]);
    }
    for (std::size_t x = 0; x < width; ++x) sums_[x] += weight * sums[x];
  }
  if (rows.behind_part == 0) return;
  const auto* behind = picture.ptr<std::uint8_t>(end);
  for (std::size_t x = 0; x < width; ++x) sums_[x] += rows.behind_part * behind[x];
}

void AreaShrinker::shrink(const cv::Mat& picture, const cv::Size& size, cv::Mat& shrunk) {
  if (picture.size() != from_ || size != to_) {
    cover(picture.cols, size.width, across_);
    cover(picture.rows, size.height, down_);
    rows_.resize(static_cast<std::size_t>(picture.cols));
    sums_.resize(static_cast<std::size_t>(picture.cols));
    from_ = picture.size();
    to_ = size;
  }
  shrunk.create(size, CV_8UC1);
  const double all = static_cast<double>(picture.cols) * picture.rows;  // weights add up to this
  for (int y = 0; y < size.height; ++y) {
    add_rows(picture, down_[static_cast<std::size_t>(y)], static_cast<std::uint32_t>(size.height));
    auto* out = shrunk.ptr<std::uint8_t>(y);
    for (const Cover& cover : across_) {
      const std::uint32_t* sum = sums_.data() + cover.first;
      std::uint64_t total = std::uint64_t{cover.first_part} * *sum++;
      std::uint64_t whole = 0;
      for (int i = 0; i < cover.whole; ++i) whole += *sum++;
      total += whole * static_cast<std::uint32_t>(size.width);
      if (cover.behind_part != 0) total += std::uint64_t{cover.behind_part} * *sum;
      // A mean of whole numbers is a half or further from it than a double's last bit.
      // NOLINTNEXTLINE(bugprone-incorrect-roundings)
      *out++ = static_cast<std::uint8_t>(static_cast<double>(total) / all + 0.5);
    }
  }
}

}  // namespace seqloop::opencv
