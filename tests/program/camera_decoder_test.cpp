// SPDX-License-Identifier: MIT
#include "program/drives/camera_decoder.hpp"

#include <gtest/gtest.h>

#include "platform/jpegs.hpp"
#include "seqloop/opencv/builtin_describer.hpp"

namespace seqloop::program {
namespace {

TEST(CameraDecoder, TakesWhateverACameraSends) {
  const auto describer = opencv::make_builtin_describer();
  CameraDecoder decoder(describer->needs());
  Image image;
  const test::Bytes jpeg = test::jpeg_of(test::textured(1280, 720));
  ASSERT_EQ(decoder.decode(test::mjpg(jpeg, 1280, 720), image), "");
  EXPECT_EQ(image.width, 640);  // a quarter would be less than twice 256x128
  EXPECT_EQ(image.format, PixelFormat::gray8);
  const test::Bytes yuyv(std::size_t{640} * 480 * 2, 100);
  ASSERT_EQ(decoder.decode({yuyv, 640, 480, 1280, RawFormat::yuyv}, image), "");
  EXPECT_EQ(image.width, 640);
  EXPECT_EQ(image.format, PixelFormat::gray8);
}

TEST(CameraDecoder, SaysWhatToDoWherePicturesAreOfAnotherSizeThanDeclared) {
  const test::Bytes jpeg = test::jpeg_of(test::textured(320, 240));
  Image image;
  CameraDecoder of_a_video({});
  EXPECT_EQ(of_a_video.decode(test::mjpg(jpeg, 640, 480), image),
            "the JPEG picture is 320x240, but 640x480 was declared");
  CameraDecoder of_a_camera({}, "ask for another --size");
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(of_a_camera.decode(test::mjpg(jpeg, 640, 480), image),
              "the JPEG picture is 320x240, but 640x480 was declared: ask for another --size");
    EXPECT_EQ(of_a_camera.decode(test::mjpg({}, 640, 480), image), "the frame is empty");
    EXPECT_EQ(of_a_camera.decode(test::mjpg(jpeg, 320, 240), image), "");
  }
}

TEST(CameraDecoder, MakesColourWhereThatIsNeeded) {
  CameraDecoder decoder({.width = 224, .height = 224});
  Image image;
  const test::Bytes jpeg = test::jpeg_of(test::textured(640, 480));
  ASSERT_EQ(decoder.decode(test::mjpg(jpeg, 640, 480), image), "");
  EXPECT_EQ(image.height, 480);  // half of it is less than twice 224
  EXPECT_EQ(image.format, PixelFormat::bgr8);
  const test::Bytes nv12(std::size_t{640} * 480 * 3 / 2, 100);
  ASSERT_EQ(decoder.decode({nv12, 640, 480, 640, RawFormat::nv12}, image), "");
  EXPECT_EQ(image.format, PixelFormat::bgr8);
}

}  // namespace
}  // namespace seqloop::program
