// SPDX-License-Identifier: MIT
#include "seqloop/opencv/raw_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "guarded_bytes.hpp"

namespace seqloop::opencv {
namespace {

using Pixel = std::array<double, 3>;  // B, G, R

constexpr std::array all_formats{RawFormat::gray8,  RawFormat::bgr8,    RawFormat::rgb8,
                                 RawFormat::yuyv,   RawFormat::uyvy,    RawFormat::nv12,
                                 RawFormat::yu12,   RawFormat::bgra8,   RawFormat::rgba8,
                                 RawFormat::gray16, RawFormat::gray16be};

bool is_gray(RawFormat format) {
  return format == RawFormat::gray8 || format == RawFormat::gray16 || format == RawFormat::gray16be;
}

/// Whether blue, green and red stand side by side; and in how many bytes.
std::size_t colour_bytes(RawFormat format) {
  if (format == RawFormat::bgr8 || format == RawFormat::rgb8) return 3;
  return format == RawFormat::bgra8 || format == RawFormat::rgba8 ? 4 : 0;
}

std::size_t shortest_stride(RawFormat format, int width) {
  const auto pixels = static_cast<std::size_t>(width);
  if (colour_bytes(format) > 0) return colour_bytes(format) * pixels;
  const bool pairs = format == RawFormat::yuyv || format == RawFormat::uyvy;
  return pairs || (is_gray(format) && format != RawFormat::gray8) ? 2 * pixels : pixels;
}

/// A picture of noise, and what its pixels are by the definition of its format.
struct Noise {
  Noise(RawFormat format, int width, int height, std::size_t padding, std::uint32_t seed = 1) {
    raw.format = format;
    raw.width = width;
    raw.height = height;
    raw.stride = shortest_stride(format, width) + padding;
    bytes.resize(bytes_of(format, raw.stride, height));
    std::mt19937 random(seed);
    std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
    raw.bytes = bytes;
  }

  [[nodiscard]] double at(std::size_t place) const { return bytes.at(place); }

  [[nodiscard]] double luma(std::size_t x, std::size_t y) const {
    const std::size_t row = y * raw.stride;
    if (raw.format == RawFormat::yuyv || raw.format == RawFormat::gray16be) return at(row + 2 * x);
    if (raw.format == RawFormat::uyvy || raw.format == RawFormat::gray16)
      return at(row + 2 * x + 1);
    return at(row + x);
  }

  [[nodiscard]] std::array<double, 2> chroma(std::size_t x, std::size_t y) const {
    const std::size_t pair = y * raw.stride + x / 2 * 4;
    const std::size_t behind_luma = raw.stride * static_cast<std::size_t>(raw.height);
    const std::size_t rows = static_cast<std::size_t>(raw.height + 1) / 2;
    switch (raw.format) {
      case RawFormat::yuyv:
        return {at(pair + 1), at(pair + 3)};
      case RawFormat::uyvy:
        return {at(pair), at(pair + 2)};
      case RawFormat::nv12: {
        const std::size_t place = behind_luma + y / 2 * raw.stride + x / 2 * 2;
        return {at(place), at(place + 1)};
      }
      default: {
        const std::size_t place = behind_luma + y / 2 * (raw.stride / 2) + x / 2;
        return {at(place), at(place + rows * (raw.stride / 2))};
      }
    }
  }

  /// BT.601, Y of 16..235.
  [[nodiscard]] Pixel colour(std::size_t x, std::size_t y) const {
    const std::size_t place = y * raw.stride + colour_bytes(raw.format) * x;
    if (raw.format == RawFormat::bgr8 || raw.format == RawFormat::bgra8)
      return {at(place), at(place + 1), at(place + 2)};
    if (raw.format == RawFormat::rgb8 || raw.format == RawFormat::rgba8)
      return {at(place + 2), at(place + 1), at(place)};
    const double light = 1.164 * std::max(luma(x, y) - 16.0, 0.0);
    const auto [u, v] = chroma(x, y);
    const auto clamped = [](double value) { return std::clamp(value, 0.0, 255.0); };
    return {clamped(light + 2.018 * (u - 128.0)),
            clamped(light - 0.391 * (u - 128.0) - 0.813 * (v - 128.0)),
            clamped(light + 1.596 * (v - 128.0))};
  }

  [[nodiscard]] double gray(std::size_t x, std::size_t y) const {
    if (colour_bytes(raw.format) == 0) return luma(x, y);
    const auto [b, g, r] = colour(x, y);
    return 0.114 * b + 0.587 * g + 0.299 * r;
  }

  std::vector<std::uint8_t> bytes;
  RawPicture raw;
};

std::string text(const RawPicture& raw) {
  return std::string(name(raw.format)) + " " + std::to_string(raw.width) + "x" +
         std::to_string(raw.height) + " rows of " + std::to_string(raw.stride);
}

void expect_gray(const Image& image, const Noise& noise) {
  ASSERT_EQ(image.format, PixelFormat::gray8);
  ASSERT_EQ(image.width, noise.raw.width);
  ASSERT_EQ(image.height, noise.raw.height);
  const bool rounds = colour_bytes(noise.raw.format) > 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x)
      ASSERT_NEAR(image.data[y * image.stride + x], noise.gray(x, y), rounds ? 1.0 : 0.0)
          << x << "," << y;
}

void expect_colour(const Image& image, const Noise& noise) {
  ASSERT_EQ(image.format, PixelFormat::bgr8);
  ASSERT_EQ(image.width, noise.raw.width);
  ASSERT_EQ(image.height, noise.raw.height);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.width); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(image.data[y * image.stride + 3 * x + c], noise.colour(x, y).at(c), 1.5)
            << x << "," << y << "," << c;
}

TEST(RawDecoder, GrayIsLumaAtEverySizeAndStride) {
  RawDecoder decoder(true);
  for (const RawFormat format : all_formats) {
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(2, 2), std::pair(3, 5), std::pair(64, 48), std::pair(65, 3)}) {
      for (const std::size_t padding : {0U, 1U, 7U, 64U}) {
        const Noise noise(format, width, height, padding);
        SCOPED_TRACE(text(noise.raw));
        Image image;
        ASSERT_EQ(decoder.decode(noise.raw, image), "");
        expect_gray(image, noise);
      }
    }
  }
}

TEST(RawDecoder, ColourIsBt601AtEverySizeAndStride) {
  RawDecoder decoder(false);
  for (const RawFormat format : all_formats) {
    if (is_gray(format)) continue;
    for (const auto& [width, height] :
         {std::pair(2, 2), std::pair(4, 6), std::pair(64, 48), std::pair(66, 2)}) {
      for (const std::size_t padding : {0U, 1U, 6U, 64U}) {
        const Noise noise(format, width, height, padding);
        SCOPED_TRACE(text(noise.raw));
        Image image;
        ASSERT_EQ(decoder.decode(noise.raw, image), "");
        expect_colour(image, noise);
      }
    }
  }
}

TEST(RawDecoder, KnownColoursComeOut) {
  struct Known {
    std::array<std::uint8_t, 3> yuv;
    Pixel bgr;
  };
  RawDecoder decoder(false);
  for (const auto& [yuv, bgr] :
       {Known{{81, 90, 240}, {0, 0, 255}}, Known{{145, 54, 34}, {0, 255, 0}},
        Known{{41, 240, 110}, {255, 0, 0}}, Known{{235, 128, 128}, {255, 255, 255}},
        Known{{16, 128, 128}, {0, 0, 0}}}) {
    const std::array<std::uint8_t, 4> pair{yuv[0], yuv[1], yuv[0], yuv[2]};
    Image image;
    ASSERT_EQ(decoder.decode({pair, 2, 1, 4, RawFormat::yuyv}, image), "");
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.data[c], bgr.at(c), 3.0);
  }
}

TEST(RawDecoder, PlanesThatAreThereAreNotCopied) {
  RawDecoder gray(true);
  RawDecoder colour(false);
  for (const RawFormat format : {RawFormat::gray8, RawFormat::nv12, RawFormat::yu12}) {
    const Noise noise(format, 6, 4, 2);
    Image image;
    ASSERT_EQ(gray.decode(noise.raw, image), "");
    EXPECT_EQ(image.data, noise.bytes.data()) << text(noise.raw);
    EXPECT_EQ(image.stride, noise.raw.stride);
  }
  const Noise noise(RawFormat::bgr8, 6, 4, 2);
  Image image;
  ASSERT_EQ(colour.decode(noise.raw, image), "");
  EXPECT_EQ(image.data, noise.bytes.data());
}

TEST(RawDecoder, ACameraWithoutColourGivesGrayWhateverIsWanted) {
  RawDecoder decoder(false);
  const Noise noise(RawFormat::gray8, 5, 3, 0);
  Image image;
  ASSERT_EQ(decoder.decode(noise.raw, image), "");
  expect_gray(image, noise);
}

TEST(RawDecoder, WhatIsWrongIsSaid) {
  const Noise good(RawFormat::yuyv, 64, 48, 0);
  RawDecoder decoder(false);
  const auto expect_fault = [&](const RawPicture& raw, const std::string& part) {
    Image image;
    const std::string fault(decoder.decode(raw, image));
    EXPECT_NE(fault.find(part), std::string::npos) << "'" << fault << "' lacks '" << part << "'";
    EXPECT_EQ(image.data, nullptr);
  };
  const auto changed = [&](auto change) {
    RawPicture raw = good.raw;
    change(raw);
    return raw;
  };
  using Raw = RawPicture;
  expect_fault(changed([](Raw& raw) { raw.bytes = raw.bytes.first(raw.bytes.size() - 1); }),
               "a YUYV picture of 64x48 with rows of 128 bytes has more than the 6143 bytes");
  expect_fault(changed([](Raw& raw) { raw.bytes = {}; }), "more than the 0 bytes");
  expect_fault(changed([](Raw& raw) { raw.width = 0; }), "no size");
  expect_fault(changed([](Raw& raw) { raw.height = 0; }), "no size");
  expect_fault(changed([](Raw& raw) { raw.width = -64; }), "no size");
  expect_fault(changed([](Raw& raw) { raw.height = std::numeric_limits<int>::min(); }), "no size");
  expect_fault(changed([](Raw& raw) { raw.stride = 127; }), "shorter than the picture is wide");
  expect_fault(changed([](Raw& raw) { raw.stride = 0; }), "shorter than the picture is wide");
  expect_fault(changed([](Raw& raw) { raw.stride = std::numeric_limits<std::size_t>::max(); }),
               "has more than the 6144 bytes");
  expect_fault(changed([](Raw& raw) {
                 raw.stride = std::numeric_limits<std::size_t>::max() / 2 + 1;
                 raw.height = 2;
               }),
               "has more than the 6144 bytes");
  expect_fault(changed([](Raw& raw) { raw.height = std::numeric_limits<int>::max(); }),
               "has more than the 6144 bytes");
  expect_fault(changed([](Raw& raw) { raw.width = 63; }), "odd size");
  expect_fault(changed([](Raw& raw) { raw.format = RawFormat::mjpg; }), "MJPG");
  expect_fault(changed([](Raw& raw) { raw.format = RawFormat::png; }), "PNG");
  const Noise odd(RawFormat::nv12, 64, 47, 0);
  expect_fault(odd.raw, "odd size");
  for (const RawFormat format : {RawFormat::nv12, RawFormat::yu12}) {
    const Noise no_chroma(format, 64, 48, 0);
    RawPicture raw = no_chroma.raw;
    raw.bytes = raw.bytes.first(64 * 48);
    expect_fault(raw, "has more than the 3072 bytes");
  }
}

TEST(RawDecoder, AFaultIsForgottenByTheNextPicture) {
  const Noise good(RawFormat::yuyv, 8, 8, 0);
  RawPicture bad = good.raw;
  bad.bytes = {};
  RawDecoder decoder(true);
  Image image;
  EXPECT_NE(decoder.decode(bad, image), "");
  EXPECT_EQ(decoder.decode(good.raw, image), "");
  expect_gray(image, good);
}

TEST(RawDecoder, WhateverIsSaidOfThePictureNothingIsReadBehindItsBytes) {
  constexpr std::uint32_t seed = 11;
  constexpr std::size_t most_bytes = 20'000;
  std::mt19937 random(seed);
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  const Noise noise(RawFormat::gray8, static_cast<int>(most_bytes), 1, 0);
  test::GuardedBytes memory(most_bytes);
  RawDecoder gray(true);
  RawDecoder colour(false);
  std::size_t taken = 0;
  std::size_t refused = 0;
  std::uint64_t sum = 0;
  for (int round = 0; round < 30'000; ++round) {
    RawPicture raw;
    raw.format = all_formats.at(below(all_formats.size()));
    raw.width = static_cast<int>(below(90));
    raw.height = static_cast<int>(below(70));
    raw.stride = shortest_stride(raw.format, raw.width) + (below(2) == 0 ? 0 : below(20));
    std::size_t size = std::min(bytes_of(raw.format, raw.stride, raw.height), most_bytes);
    switch (below(12)) {  // mostly right, else one thing is wild
      case 0:
        size = below(size + 1);
        break;
      case 1:
        raw.width = static_cast<int>(random());
        break;
      case 2:
        raw.height = static_cast<int>(random());
        break;
      case 3:
        raw.stride = static_cast<std::size_t>(random()) << below(33);
        break;
      default:
        break;
    }
    raw.bytes = memory.hold(std::span(noise.bytes).first(size));
    RawDecoder& decoder = below(2) == 0 ? gray : colour;
    Image image;
    if (!decoder.decode(raw, image).empty()) {
      ++refused;
      continue;
    }
    ++taken;
    const std::size_t row =
        static_cast<std::size_t>(image.width) * (image.format == PixelFormat::gray8 ? 1 : 3);
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y)
      for (std::size_t x = 0; x < row; ++x) sum += image.data[y * image.stride + x];
  }
  std::printf("seed %u: %zu taken, %zu refused, sum %llu\n", seed, taken, refused,
              static_cast<unsigned long long>(sum));
  EXPECT_GT(taken, 10'000U);
  EXPECT_GT(refused, 5'000U);
}

}  // namespace
}  // namespace seqloop::opencv
