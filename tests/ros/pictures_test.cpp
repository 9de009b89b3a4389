// SPDX-License-Identifier: MIT
#include "ros/pictures.hpp"

#include <algorithm>
#include <array>

#include "bags/bag_bytes.hpp"
#include "gtest/gtest.h"

namespace seqloop::ros {
namespace {

constexpr std::int64_t stamp = 1'700'000'000'123'456'789;
const std::vector<std::uint8_t> pixels{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

TEST(Messages, ImagesOfEveryEncodingInBothByteOrders) {
  struct Case {
    const char* encoding;
    RawFormat format;
  };
  const std::array cases{Case{"mono8", RawFormat::gray8},      Case{"rgb8", RawFormat::rgb8},
                         Case{"bgr8", RawFormat::bgr8},        Case{"rgba8", RawFormat::rgba8},
                         Case{"bgra8", RawFormat::bgra8},      Case{"mono16", RawFormat::gray16},
                         Case{"yuv422", RawFormat::uyvy},      Case{"uyvy", RawFormat::uyvy},
                         Case{"yuv422_yuy2", RawFormat::yuyv}, Case{"yuyv", RawFormat::yuyv},
                         Case{"8UC1", RawFormat::gray8},       Case{"8UC3", RawFormat::bgr8},
                         Case{"16UC1", RawFormat::gray16}};
  for (const Case& one : cases)
    for (const bool little : {true, false}) {
      SCOPED_TRACE(std::string(one.encoding) + (little ? ", little" : ", big"));
      const auto message = test::image_message(stamp, 3, 4, one.encoding, 3, pixels, little);
      FixedText fault;
      const PictureMessage read = read_picture(PictureType::image, message, fault);
      EXPECT_EQ(fault.view(), "");
      EXPECT_EQ(read.stamp_ns, stamp);
      EXPECT_EQ(read.picture.format, one.format);
      EXPECT_EQ(read.picture.width, 3);
      EXPECT_EQ(read.picture.height, 4);
      EXPECT_EQ(read.picture.stride, 3U);
      ASSERT_TRUE(std::ranges::equal(read.picture.bytes, pixels));
      // No copy.
      EXPECT_GE(read.picture.bytes.data(), message.data());
      EXPECT_LE(read.picture.bytes.data() + pixels.size(), message.data() + message.size());
    }
}

TEST(Messages, SixteenBitsOfEitherByteOrder) {
  FixedText fault;
  const auto message = test::image_message(stamp, 2, 3, "mono16", 4, pixels, true, true);
  EXPECT_EQ(read_picture(PictureType::image, message, fault).picture.format, RawFormat::gray16be);
}

TEST(Messages, CompressedPicturesAreKnownByTheirBytes) {
  FixedText fault;
  const std::array<std::uint8_t, 4> jpeg{0xff, 0xd8, 0xff, 0xe0};
  const std::array<std::uint8_t, 4> png{0x89, 'P', 'N', 'G'};
  const auto format = [&](std::span<const std::uint8_t> data) {
    return read_picture(PictureType::compressed,
                        test::compressed_message(stamp, "rgb8; whatever", data), fault)
        .picture.format;
  };
  EXPECT_EQ(format(jpeg), RawFormat::mjpg);
  EXPECT_EQ(format(png), RawFormat::png);
  EXPECT_EQ(fault.view(), "");
  static_cast<void>(format(pixels));
  EXPECT_EQ(fault.view(), "the compressed picture ('rgb8; whatever') is neither JPEG nor PNG");
}

TEST(Messages, CutOffAnywhereIsAFault) {
  const auto whole = test::image_message(stamp, 3, 4, "mono8", 3, pixels);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    FixedText fault;
    const auto read = read_picture(PictureType::image, std::span(whole).first(size), fault);
    EXPECT_FALSE(fault.empty()) << size;
    EXPECT_TRUE(read.picture.bytes.empty());
  }
}

TEST(Messages, HostileSizes) {
  FixedText fault;
  auto message = test::image_message(stamp, 0xffffffffU, 4, "mono8", 3, pixels);
  EXPECT_TRUE(read_picture(PictureType::image, message, fault).picture.bytes.empty());
  EXPECT_EQ(fault.view(), "no picture is as large as it says");
  message = test::Cdr()
                .header(stamp)
                .put(2U)
                .put(2U)
                .text("mono8")
                .put(std::uint8_t{0})
                .put(2U)
                .put(0xfffffff0U)
                .bytes();
  EXPECT_TRUE(read_picture(PictureType::image, message, fault).picture.bytes.empty());
  EXPECT_EQ(fault.view(), "the message ends before its last value");
  message = test::Cdr().put(1).put(1U).put(0xffffffffU).bytes();  // the frame's name
  static_cast<void>(read_picture(PictureType::image, message, fault));
  EXPECT_EQ(fault.view(), "the message ends before its last value");
  message[1] = 3;  // parameter lists
  static_cast<void>(read_picture(PictureType::image, message, fault));
  EXPECT_EQ(fault.view(), "the message is not serialised as plain CDR");
}

TEST(Messages, TypesOfOldAndNewBags) {
  EXPECT_EQ(picture_type("sensor_msgs/msg/Image"), PictureType::image);
  EXPECT_EQ(picture_type("sensor_msgs/Image"), PictureType::image);
  EXPECT_EQ(picture_type("sensor_msgs/msg/CompressedImage"), PictureType::compressed);
  EXPECT_EQ(picture_type("sensor_msgs/msg/PointCloud2"), PictureType::none);
}

}  // namespace
}  // namespace seqloop::ros
