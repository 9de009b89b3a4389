// SPDX-License-Identifier: MIT
// Which of its modes a camera is run in, case by case.
#include "linux/choose_mode.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::live {
namespace {

CameraMode mode(std::uint32_t fourcc, int width, int height, std::uint32_t fps) {
  return {fourcc, *readable(fourcc), width, height, fps == 0 ? 0U : 1U, fps};
}

struct Case {
  const char* name;
  CameraWish wish;
  std::vector<CameraMode> offered;
  std::vector<std::string> order;
};

class ChooseMode : public testing::TestWithParam<Case> {};

TEST_P(ChooseMode, PutsTheBestInFront) {
  std::vector<std::string> order;
  for (const CameraMode& chosen : choose_mode(GetParam().offered, GetParam().wish)) {
    order.push_back(to_string(chosen));
  }
  EXPECT_EQ(order, GetParam().order);
}

constexpr std::uint32_t grey = V4L2_PIX_FMT_GREY;
constexpr std::uint32_t bgr = V4L2_PIX_FMT_BGR24;
constexpr std::uint32_t rgb = V4L2_PIX_FMT_RGB24;
constexpr std::uint32_t yuyv = V4L2_PIX_FMT_YUYV;
constexpr std::uint32_t nv12 = V4L2_PIX_FMT_NV12;
constexpr std::uint32_t jpeg = V4L2_PIX_FMT_MJPEG;

INSTANTIATE_TEST_SUITE_P(
    By, ChooseMode,
    testing::Values(
        Case{"formatForGrey",
             {.least_width = 64, .least_height = 48},
             {mode(jpeg, 64, 48, 10), mode(rgb, 64, 48, 10), mode(yuyv, 64, 48, 10),
              mode(nv12, 64, 48, 10), mode(grey, 64, 48, 10)},
             {"GREY 64x48 at 10 fps", "NV12 64x48 at 10 fps", "YUYV 64x48 at 10 fps",
              "RGB3 64x48 at 10 fps", "MJPG 64x48 at 10 fps"}},
        Case{"formatForColour",
             {.least_width = 64, .least_height = 48, .colour = true},
             {mode(grey, 64, 48, 10), mode(jpeg, 64, 48, 10), mode(nv12, 64, 48, 10),
              mode(yuyv, 64, 48, 10), mode(rgb, 64, 48, 10), mode(bgr, 64, 48, 10)},
             {"BGR3 64x48 at 10 fps", "RGB3 64x48 at 10 fps", "YUYV 64x48 at 10 fps",
              "NV12 64x48 at 10 fps", "MJPG 64x48 at 10 fps"}},
        Case{"theSmallestSizeThatIsLargeEnoughBothWays",
             {.least_width = 128, .least_height = 64},
             {mode(yuyv, 640, 480, 10), mode(yuyv, 160, 120, 10), mode(yuyv, 256, 60, 10),
              mode(yuyv, 320, 240, 10), mode(yuyv, 64, 64, 10)},
             {"YUYV 160x120 at 10 fps", "YUYV 320x240 at 10 fps", "YUYV 640x480 at 10 fps",
              "YUYV 256x60 at 10 fps", "YUYV 64x64 at 10 fps"}},
        Case{"theLowestRateThatIsHighEnough",
             {.rate = 12},
             {mode(yuyv, 64, 48, 30), mode(yuyv, 64, 48, 5), mode(yuyv, 64, 48, 15),
              mode(yuyv, 64, 48, 10)},
             {"YUYV 64x48 at 15 fps", "YUYV 64x48 at 30 fps", "YUYV 64x48 at 10 fps",
              "YUYV 64x48 at 5 fps"}},
        Case{"rateBeforeSizeWhereNotBothCanBeHad",
             {.least_width = 640, .least_height = 480},
             {mode(yuyv, 640, 480, 5), mode(jpeg, 1280, 720, 30), mode(yuyv, 320, 240, 30)},
             {"MJPG 1280x720 at 30 fps", "YUYV 320x240 at 30 fps", "YUYV 640x480 at 5 fps"}},
        Case{"aLargeJpegIsCheaperThanItsPixels",
             {.least_width = 128, .least_height = 64},
             {mode(rgb, 1280, 960, 30), mode(jpeg, 640, 480, 30), mode(yuyv, 800, 600, 30)},
             {"YUYV 800x600 at 30 fps", "MJPG 640x480 at 30 fps", "RGB3 1280x960 at 30 fps"}},
        Case{"twentyNinePointNineSevenIsThirty",
             {.rate = 30},
             {mode(yuyv, 64, 48, 60), {yuyv, RawFormat::yuyv, 64, 48, 1001, 30000}},
             {"YUYV 64x48 at 29.97 fps", "YUYV 64x48 at 60 fps"}},
        Case{"anUnknownRateCountsAsTheWishedOne",
             {.rate = 10},
             {mode(yuyv, 64, 48, 30), mode(yuyv, 64, 48, 0), mode(yuyv, 64, 48, 5)},
             {"YUYV 64x48", "YUYV 64x48 at 30 fps", "YUYV 64x48 at 5 fps"}},
        Case{"onlyWhatTheUserInsistsOn",
             {.format = RawFormat::mjpg, .size = std::pair(640, 480)},
             {mode(yuyv, 640, 480, 30), mode(jpeg, 640, 480, 30), mode(jpeg, 320, 240, 30)},
             {"MJPG 640x480 at 30 fps"}},
        Case{"noGreyWhereColourIsNeeded", {.colour = true}, {mode(grey, 640, 480, 30)}, {}},
        Case{"nothing", {}, {}, {}}, Case{"noSizeAtAll", {}, {mode(yuyv, 0, 0, 30)}, {}}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(PixelFormats, HaveFourLetters) {
  EXPECT_EQ(fourcc_text(yuyv), "YUYV");
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Y16), "Y16");
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Y16_BE), "Y16-BE");
  EXPECT_EQ(fourcc_text(0), "????");
  EXPECT_EQ(format_named("mjpg"), RawFormat::mjpg);
  EXPECT_EQ(format_named("YU12"), RawFormat::yu12);
  EXPECT_EQ(format_named("H264"), std::nullopt);
  EXPECT_EQ(readable(V4L2_PIX_FMT_JPEG), RawFormat::mjpg);
  EXPECT_EQ(readable(V4L2_PIX_FMT_H264), std::nullopt);
}

TEST(PixelFormats, NeedAllBytesButThePaddingOfTheLastRow) {
  EXPECT_EQ(least_bytes(RawFormat::yuyv, 100, 40, 3), 280U);
  EXPECT_EQ(least_bytes(RawFormat::gray8, 40, 40, 3), 120U);
  EXPECT_EQ(least_bytes(RawFormat::yu12, 48, 40, 4), 48U * 6 - 4);
  EXPECT_EQ(least_bytes(RawFormat::mjpg, 0, 40, 3), 1U);
}

}  // namespace
}  // namespace seqloop::live
