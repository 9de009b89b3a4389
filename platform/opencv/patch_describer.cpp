// SPDX-License-Identifier: MIT
#include "seqloop/opencv/patch_describer.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "opencv/detail/guarded.hpp"
#include "opencv/detail/picture_scaler.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {
namespace {

constexpr int side = PatchDescriber::patch;
constexpr int pixels = side * side;
constexpr int largest_side = 8192;  // pixels; beyond it a mistyped size would take all memory

cv::Size checked(int width, int height) {
  const auto fits = [](int length) {
    return length > 0 && length <= largest_side && length % side == 0;
  };
  if (fits(width) && fits(height)) return {width, height};
  throw SetupError(Fault{"input size",
                         std::to_string(width) + "x" + std::to_string(height) +
                             " is no whole number of patches of 8x8 pixels",
                         "give multiples of 8, up to " + std::to_string(largest_side)});
}

/// @param patch 8x8 pixels   @param out [8, 8] with `stride` values from row to row
/// @return false where the patch is flat
bool normalise(const cv::Mat& patch, float* out, std::size_t stride) {
  int sum = 0;
  int squares = 0;
  for (int y = 0; y < side; ++y) {
    for (const std::uint8_t value : std::span(patch.ptr(y), std::size_t{side})) {
      sum += value;
      squares += value * value;
    }
  }
  // Of whole numbers, so that flat is flat.
  const int spread = pixels * squares - sum * sum;
  const double deviation = std::sqrt(static_cast<double>(spread) / (pixels * (pixels - 1)));
  const double mean = static_cast<double>(sum) / pixels;
  for (int y = 0; y < side; ++y, out += stride) {
    const std::uint8_t* row = patch.ptr(y);
    for (int x = 0; x < side; ++x) {
      const double z = spread == 0 ? 0.0 : (row[x] - mean) / deviation;
      out[x] = static_cast<float>((std::clamp(z, -4.0, 4.0) + 4.0) * (255.0 / 8.0));
    }
  }
  return spread > 0;
}

}  // namespace

class PatchDescriber::Impl {
 public:
  Impl(int width, int height) : size_(checked(width, height)), scaler_(size_, true) {}

  /// May throw.
  [[nodiscard]] Description describe(const Image& image, std::span<float> descriptor) {
    const cv::Mat picture = scaler_.scale(image);
    const auto stride = static_cast<std::size_t>(size_.width);
    bool flat = true;
    for (int y = 0; y < size_.height; y += side) {
      for (int x = 0; x < size_.width; x += side) {
        float* out =
            &descriptor[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
        if (normalise(picture(cv::Rect(x, y, side, side)), out, stride)) flat = false;
      }
    }
    return flat ? Description::blank : Description::good;
  }

  [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(size_.area()); }
  [[nodiscard]] PictureNeeds needs() const noexcept {
    return {.width = size_.width, .height = size_.height, .gray_is_enough = true};
  }
  [[nodiscard]] std::string& fault() noexcept { return fault_; }

 private:
  cv::Size size_;
  PictureScaler scaler_;
  std::string fault_;
};

PatchDescriber::PatchDescriber(int width, int height)
    : impl_(std::make_unique<Impl>(width, height)) {}

PatchDescriber::~PatchDescriber() = default;

std::size_t PatchDescriber::size() const noexcept { return impl_->size(); }

PictureNeeds PatchDescriber::needs() const noexcept { return impl_->needs(); }

Description PatchDescriber::describe(const Image& image, std::span<float> descriptor) noexcept {
  return guarded(impl_->fault(), image, descriptor, size(),
                 [&] { return impl_->describe(image, descriptor); });
}

std::string_view PatchDescriber::last_fault() const noexcept { return impl_->fault(); }

}  // namespace seqloop::opencv
