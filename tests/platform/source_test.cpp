// SPDX-License-Identifier: MIT
#include "seqloop/opencv/source.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "expect_setup_error.hpp"
#include "platform/pictures.hpp"
#include "seqloop/opencv/silence.hpp"

namespace seqloop::opencv {
namespace {

using test::encoded;
using test::says;
using test::setup_error;
using test::TemporaryFolder;
using test::textured;

std::string open_error(const std::filesystem::path& path) {
  return setup_error([&] { static_cast<void>(open_source(path)); });
}

TEST(OpenSource, HandsItsOptionsToTheFolder) {
  const TemporaryFolder folder;
  folder.write("1.png", encoded(textured(8, 8), ".png"));
  folder.write("2.png", encoded(textured(8, 8), ".png"));
  const auto source = open_source(folder.path(), {true, 2.0});
  Frame frame;
  ASSERT_EQ(source->grab(frame), Grab::frame);
  ASSERT_EQ(source->grab(frame), Grab::frame);
  EXPECT_EQ(frame.time_s, 0.5);
  EXPECT_EQ(frame.image.format, PixelFormat::gray8);
}

// Bad input: what is neither a folder of pictures nor a video.
TEST(OpenSource, NamesWhatItCannotOpen) {
  silence_opencv();
  const TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_TRUE(says(open_error(folder.path() / "none"), "does not exist"));
  for (const char* address : {"rtsp://10.0.0.5/stream", "http://10.0.0.5:8080/video.mjpg"})
    EXPECT_TRUE(says(open_error(address), "is an address of a network, and no file; feed it"));
  EXPECT_TRUE(says(open_error("/dev/null"), "is a device, not a recording"));
  EXPECT_TRUE(says(open_error(pipe), "is neither a folder nor a file"));
  EXPECT_TRUE(says(open_error(folder.write("1.JPG", encoded(textured(8, 8), ".jpg"))),
                   "is a single picture"));
  EXPECT_TRUE(says(open_error(folder.write("drive.mp4", "text")), "is not a video"));
}

}  // namespace
}  // namespace seqloop::opencv
