// SPDX-License-Identifier: MIT
// On its own, because it replaces malloc.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "core/allocation_guard.hpp"
#include "platform/jpegs.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/opencv/raw_decoder.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop {
namespace {

/// Allocations of the second decoding.
std::size_t allocations(PictureDecoder& decoder, const RawPicture& raw) {
  Image image;
  EXPECT_EQ(decoder.decode(raw, image), "");
  const AllocationGuard guard;
  EXPECT_EQ(decoder.decode(raw, image), "");
  return guard.count();
}

TEST(DecoderAllocations, RawPicturesNeedNoneOnceTheirSizeHasBeenSeen) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "sanitizers bring a heap of their own";
  for (const RawFormat format :
       {RawFormat::gray8, RawFormat::bgr8, RawFormat::rgb8, RawFormat::yuyv, RawFormat::uyvy,
        RawFormat::nv12, RawFormat::yu12}) {
    for (const bool gray : {true, false}) {
      constexpr std::size_t stride = 640 * 3;
      const std::vector<std::uint8_t> bytes(bytes_of(format, stride, 480), 100);
      opencv::RawDecoder decoder(gray);
      EXPECT_EQ(allocations(decoder, {bytes, 640, 480, stride, format}), 0U) << name(format);
      RawPicture bad{bytes, 640, 480, 1, format};
      Image image;
      const AllocationGuard guard;
      EXPECT_FALSE(decoder.decode(bad, image).empty());
      EXPECT_EQ(guard.count(), 0U) << "the fault of " << name(format);
    }
  }
}

TEST(DecoderAllocations, LibjpegsDoNotGrowWithThePicture) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "sanitizers bring a heap of their own";
  constexpr std::size_t most = 16;
  for (const PictureNeeds& needs :
       {PictureNeeds{.gray_is_enough = true}, PictureNeeds{},
        PictureNeeds{.width = 128, .height = 64, .gray_is_enough = true}}) {
    for (const auto& [width, height] : {std::pair(320, 240), std::pair(1920, 1080)}) {
      turbojpeg::MjpgDecoder decoder(needs);
      const test::Bytes jpeg = test::jpeg_of(test::textured(width, height));
      const std::size_t count = allocations(decoder, test::mjpg(jpeg, width, height));
      std::printf("%dx%d for %dx%d%s: %zu allocations\n", width, height, needs.width, needs.height,
                  needs.gray_is_enough ? " grey" : "", count);
      EXPECT_LE(count, most);
    }
  }
}

TEST(DescriberAllocations, TheBuiltInNeedsNoneForGrayPicturesThatShrink) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "sanitizers bring a heap of their own";
  const auto describer = opencv::make_builtin_describer();
  std::vector<float> values(describer->size());
  for (const cv::Size& size : {cv::Size(256, 128), cv::Size(640, 480), cv::Size(960, 540)}) {
    const cv::Mat picture = test::textured(size.width, size.height, 1, CV_8UC1);
    const Image image = test::image_of(picture);
    ASSERT_EQ(describer->describe(image, values), Description::good);
    const AllocationGuard guard;
    ASSERT_EQ(describer->describe(image, values), Description::good);
    EXPECT_EQ(guard.count(), 0U) << size;
  }
}

}  // namespace
}  // namespace seqloop
