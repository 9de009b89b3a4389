// SPDX-License-Identifier: MIT
// Lens and sensor.
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "renderer.hpp"

namespace seqloop::street {
namespace {

constexpr int kCurve = 4096;
constexpr float kCurveTop = 6.0F;

/// Film-like curve: linear light 0..kCurveTop to 0..255.
const std::array<float, kCurve>& tone_curve() {
  static const std::array<float, kCurve> curve = [] {
    std::array<float, kCurve> c{};
    for (int i = 0; i < kCurve; ++i) {
      const double x =
          std::pow(static_cast<double>(i) / (kCurve - 1), 2.0) * static_cast<double>(kCurveTop);
      c[static_cast<std::size_t>(i)] =
          static_cast<float>(255.0 * std::pow(1.0 - std::exp(-1.15 * x), 1.0 / 1.9));
    }
    return c;
  }();
  return curve;
}

std::uint8_t to_byte(float x) noexcept {
  return static_cast<std::uint8_t>(std::clamp(x + 0.5F, 0.0F, 255.0F));
}

}  // namespace

void develop(const std::vector<Color>& picture, const Light& light, std::uint64_t noise_seed,
             cv::Mat& image) {
  const auto& curve = tone_curve();
  const auto tone = [&curve](float x) {
    const float t = std::sqrt(std::clamp(x * (1.0F / kCurveTop), 0.0F, 1.0F));
    return curve[static_cast<std::size_t>(t * (kCurve - 1))];
  };
  const Color gain = light.cast * light.exposure;
  const float half_w = 0.5F * static_cast<float>(image.cols);
  const float half_h = 0.5F * static_cast<float>(image.rows);
  std::size_t i = 0;
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<std::uint8_t>(y);
    const float fy = (static_cast<float>(y) - half_h) / half_h;
    for (int x = 0; x < image.cols; ++x, ++i) {
      const float fx = (static_cast<float>(x) - half_w) / half_w;
      const Color c = picture[i] * gain * (1.0F - light.vignette * 0.5F * (fx * fx + fy * fy));
      row[3 * x] = to_byte(tone(c.b));
      row[3 * x + 1] = to_byte(tone(c.g));
      row[3 * x + 2] = to_byte(tone(c.r));
    }
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.55, 0.55, cv::BORDER_REPLICATE);
  // Sum of four bytes: close to a normal distribution, variance 4 * (256^2 - 1) / 12.
  const float grain = light.sensor_noise / 147.8F;
  std::uint64_t state = noise_seed;
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x) {
      const std::uint64_t bits = mix64(state++);
      const auto byte = [bits](unsigned k) { return static_cast<int>((bits >> (8U * k)) & 0xffU); };
      const float luma = static_cast<float>(byte(0) + byte(1) + byte(2) + byte(3) - 510) * grain;
      const float chroma = static_cast<float>(byte(4) + byte(5) - 255) * grain * 0.6F;
      row[3 * x] = to_byte(static_cast<float>(row[3 * x]) + luma + chroma);
      row[3 * x + 1] = to_byte(static_cast<float>(row[3 * x + 1]) + luma);
      row[3 * x + 2] = to_byte(static_cast<float>(row[3 * x + 2]) + luma - chroma);
    }
  }
}

}  // namespace seqloop::street
