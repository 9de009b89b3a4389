// SPDX-License-Identifier: MIT
#include "experiment/run/matrix_recorder.hpp"

#include <algorithm>
#include <iterator>
#include <opencv2/core.hpp>

#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::experiment {
namespace {

constexpr std::size_t most = 400;

std::size_t step_for(std::uint64_t count) {
  return static_cast<std::size_t>((count + most - 1) / most);
}

}  // namespace

MatrixRecorder::MatrixRecorder(std::uint64_t columns) noexcept
    : step_(std::max<std::uint64_t>(step_for(columns), 1)) {}

void MatrixRecorder::add(std::span<const float> column) {
  if (frame_++ % step_ != 0) return;
  std::vector<float>& thin = columns_.emplace_back();
  for (std::size_t row = 0; row < column.size(); row += step_for(column.size())) {
    thin.push_back(column[row]);
  }
}

std::vector<std::uint8_t> MatrixRecorder::png() const {
  std::vector<float> sorted;
  for (const auto& column : columns_) {
    std::ranges::copy_if(column, std::back_inserter(sorted), [](float d) { return d >= 0.0F; });
  }
  if (sorted.empty()) return {};
  std::ranges::sort(sorted);
  // The middle 98 % of the differences take all greys.
  const float low = sorted[sorted.size() / 100];
  const float high = std::max(sorted[sorted.size() - 1 - sorted.size() / 100], low + 1e-9F);
  constexpr int white = 255;
  constexpr float lightest = 250.0F;
  cv::Mat picture(static_cast<int>(columns_.front().size()), static_cast<int>(columns_.size()),
                  CV_8UC1, cv::Scalar(white));
  for (int x = 0; x < picture.cols; ++x) {
    const std::vector<float>& column = columns_[static_cast<std::size_t>(x)];
    for (int y = 0; y < picture.rows; ++y) {
      const float difference = column[static_cast<std::size_t>(y)];
      if (difference < 0.0F) continue;
      const float share = std::clamp((difference - low) / (high - low), 0.0F, 1.0F);
      picture.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(share * lightest);
    }
  }
  std::vector<std::uint8_t> bytes;
  opencv::file_codecs().encode(".png", picture, bytes);
  return bytes;
}

}  // namespace seqloop::experiment
