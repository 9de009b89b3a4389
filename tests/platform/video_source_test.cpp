// SPDX-License-Identifier: MIT
#include "seqloop/opencv/video_source.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/videoio.hpp>

#include "expect_setup_error.hpp"
#include "platform/pictures.hpp"
#include "seqloop/opencv/silence.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop::opencv {
namespace {

using test::says;
using test::setup_error;
using test::TemporaryFolder;

constexpr int frames = 12;

/// A motion JPEG of flat pictures that grow brighter, 20 frames a second.
std::filesystem::path make_video(const TemporaryFolder& folder) {
  const auto path = folder.path() / "drive.avi";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                         cv::Size(64, 48));
  for (int i = 0; i < frames; ++i)
    writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20.0 * i)));
  return path;
}

std::string open_error(const std::filesystem::path& path) {
  return setup_error([&] { VideoSource source(path, false); });
}

class VideoSourceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { silence_opencv(); }
};

TEST_F(VideoSourceTest, HandsOverEveryFrameWithItsTime) {
  const TemporaryFolder folder;
  for (const bool gray : {false, true}) {
    VideoSource source(make_video(folder), gray);
    EXPECT_EQ(source.frame_count(), static_cast<std::uint64_t>(frames));
    Frame frame;
    for (int i = 0; i < frames; ++i) {
      ASSERT_EQ(source.grab(frame), Grab::frame);
      EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
      EXPECT_NEAR(frame.time_s, 0.05 * i, 1e-6);
      EXPECT_EQ(frame.image.width, 64);
      EXPECT_EQ(frame.image.height, 48);
      EXPECT_EQ(frame.image.format, gray ? PixelFormat::gray8 : PixelFormat::bgr8);
      EXPECT_NEAR(frame.image.data[0], 20 * i, 4);
    }
    EXPECT_EQ(source.grab(frame), Grab::end);
    EXPECT_EQ(source.grab(frame), Grab::end);
    EXPECT_TRUE(source.notes().empty());
  }
}

/// To grey pictures of half the size.
std::unique_ptr<PictureDecoder> small_and_gray() {
  return std::make_unique<turbojpeg::MjpgDecoder>(
      PictureNeeds{.width = 32, .height = 24, .gray_is_enough = true});
}

TEST_F(VideoSourceTest, LeavesMotionJpegToADecoder) {
  const TemporaryFolder folder;
  const auto path = make_video(folder);
  VideoSource whole(path, true);
  VideoSource source(path, false, small_and_gray());
  EXPECT_EQ(source.frame_count(), whole.frame_count());
  Frame expected;
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(whole.grab(expected), Grab::frame);
    ASSERT_EQ(source.grab(frame), Grab::frame);
    EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(frame.time_s, expected.time_s);
    EXPECT_EQ(frame.image.width, 32);
    EXPECT_EQ(frame.image.height, 24);
    EXPECT_EQ(frame.image.format, PixelFormat::gray8);
    EXPECT_NEAR(frame.image.data[0], expected.image.data[0], 2);
  }
  EXPECT_EQ(source.grab(frame), Grab::end);
  EXPECT_EQ(source.grab(frame), Grab::end);
  EXPECT_TRUE(source.notes().empty());
}

/// Where the n-th picture's chunk begins.
std::size_t picture_chunk(const std::string& avi, int n) {
  std::size_t place = avi.find("movi");
  for (; n >= 0; --n) place = avi.find("00dc", place + 4);
  return place;
}

TEST_F(VideoSourceTest, AMomentWithoutAPictureTakesItsTime) {
  const TemporaryFolder folder;
  std::string file = test::read_all(make_video(folder));
  file.insert(picture_chunk(file, 2), std::string("00dc\0\0\0\0", 8));
  VideoSource source(folder.write("gap.avi", file), false, small_and_gray());
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(source.grab(frame), Grab::frame);
    EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(frame.time_s, 0.05 * (i < 2 ? i : i + 1));
  }
}

/// Little-endian, as AVI files have them.
void set_number(std::string& bytes, std::size_t place, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes.at(place + i) = static_cast<char>(value >> 8 * i);
}

// The header counts them, too.
TEST_F(VideoSourceTest, MomentsWithoutAPictureDoNotEndAVideoEarly) {
  const TemporaryFolder folder;
  std::string file = test::read_all(make_video(folder));
  file.insert(picture_chunk(file, 2), std::string("00dc\0\0\0\0", 8));
  const auto notes = [&](std::uint32_t declared) {
    set_number(file, file.find("strh") + 8 + 32, declared);
    VideoSource source(folder.write("gap.avi", file), false, small_and_gray());
    Frame frame;
    while (source.grab(frame) != Grab::end) {
    }
    return source.notes();
  };
  EXPECT_EQ(notes(frames + 1), std::vector<std::string>());
  EXPECT_EQ(notes(frames + 2),
            std::vector<std::string>{"the video ended after 13 of the 14 frames that it declares"});
}

// Bad input: what is no picture ends the video where OpenCV decodes it. Of a damaged one the rest
// is made up there, without a word.
TEST_F(VideoSourceTest, TellsOfDamagedPictures) {
  const TemporaryFolder folder;
  std::string file = test::read_all(make_video(folder));
  file[picture_chunk(file, 3) + 8] = 'x';
  const std::size_t end = file.find("\xff\xd9", picture_chunk(file, 5));
  file.replace(end - 16, 16, std::string(16, '\xff'));
  VideoSource source(folder.write("damaged.avi", file), false, small_and_gray());
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(source.grab(frame), i == 3 ? Grab::unreadable : Grab::frame);
    EXPECT_DOUBLE_EQ(frame.time_s, 0.05 * i);
    EXPECT_EQ(frame.image.data == nullptr, i == 3);
    EXPECT_EQ(says(std::string(frame.fault), "is no JPEG picture"), i == 3);
    EXPECT_EQ(says(std::string(frame.remark), "the JPEG picture is damaged"), i == 5);
  }
  EXPECT_EQ(source.grab(frame), Grab::end);
}

// Bad input: webcams often damage the first picture. What follows is read, and its damage told.
TEST_F(VideoSourceTest, AFirstPictureThatIsDamagedIsOneUnreadableFrame) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(make_video(folder));
  std::string none = whole;
  none[picture_chunk(none, 0) + 8] = 'x';
  std::string half = whole;  // grey from its middle on, where OpenCV decodes it
  const std::size_t first = picture_chunk(half, 0) + 8;
  const std::size_t middle = (first + picture_chunk(half, 1)) / 2;
  std::fill_n(half.begin() + static_cast<std::ptrdiff_t>(middle), picture_chunk(half, 1) - middle,
              '\0');
  for (const auto& [damaged, fault] :
       {std::pair{none, "is no JPEG picture"}, {half, "the JPEG picture is damaged"}}) {
    VideoSource source(folder.write("damaged.avi", damaged), false, small_and_gray());
    EXPECT_EQ(source.frame_count(), static_cast<std::uint64_t>(frames));
    Frame frame;
    for (int i = 0; i < frames; ++i) {
      ASSERT_EQ(source.grab(frame), i == 0 ? Grab::unreadable : Grab::frame) << i;
      EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
      EXPECT_DOUBLE_EQ(frame.time_s, 0.05 * i);
      EXPECT_EQ(says(std::string(frame.fault), fault), i == 0) << frame.fault;
    }
    EXPECT_EQ(source.grab(frame), Grab::end);
    EXPECT_TRUE(source.notes().empty());
  }
}

// Bad input: OpenCV finds no frame in it then.
TEST_F(VideoSourceTest, WhatFollowsManyPicturesThatAreNoneIsRead) {
  const TemporaryFolder folder;
  std::string file = test::read_all(make_video(folder));
  for (int i = 0; i < frames - 1; ++i) {
    const std::size_t first = picture_chunk(file, i) + 8;
    std::fill(file.begin() + static_cast<std::ptrdiff_t>(first),
              file.begin() + static_cast<std::ptrdiff_t>(picture_chunk(file, i + 1)), '\0');
  }
  VideoSource source(folder.write("late.avi", file), false, small_and_gray());
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(source.grab(frame), i < frames - 1 ? Grab::unreadable : Grab::frame) << i;
    EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(frame.time_s, 0.05 * i);
  }
  EXPECT_EQ(source.grab(frame), Grab::end);
  EXPECT_TRUE(source.notes().empty());
}

TEST_F(VideoSourceTest, WhatTheDecoderDoesNotTakeIsLeftToOpenCv) {
  const TemporaryFolder folder;
  std::string file = test::read_all(make_video(folder));
  file.at(file.find("strf") + 8 + 4) = 72;  // the width
  VideoSource source(folder.write("half.avi", file), false, small_and_gray());
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(source.grab(frame), Grab::frame);
    EXPECT_NEAR(frame.time_s, 0.05 * i, 1e-6);
    EXPECT_EQ(frame.image.format, PixelFormat::bgr8);
  }
  EXPECT_EQ(source.grab(frame), Grab::end);
  ASSERT_EQ(source.notes().size(), 1U);
  EXPECT_TRUE(
      says(source.notes()[0],
           "none of its first pictures can be decoded by itself (the JPEG picture is 64x48, "
           "but 72x48 was declared): OpenCV reads the video"));
}

// Bad input: a video that was cut off.
TEST_F(VideoSourceTest, NotesThatAVideoEndedEarly) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(make_video(folder));
  const std::size_t cut = whole.find("movi") + 4 + (whole.size() - whole.find("movi")) / 2;
  const auto path = folder.write("cut.avi", whole.substr(0, cut));
  for (const bool decoder : {false, true}) {
    VideoSource source(path, false, decoder ? small_and_gray() : nullptr);
    Frame frame;
    int count = 0;
    while (source.grab(frame) == Grab::frame) ++count;
    EXPECT_GT(count, 0);
    EXPECT_LT(count, frames);
    ASSERT_EQ(source.notes().size(), 1U);
    EXPECT_TRUE(says(source.notes()[0], "ended after " + std::to_string(count) + " of the 12"));
  }
}

// Bad input: a video without a frame rate, which OpenCV silently takes for 25.
TEST_F(VideoSourceTest, NotesThatAVideoHasNoFrameRate) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(make_video(folder));
  const std::size_t frame_time = whole.find("avih") + 8;
  const std::size_t rate = whole.find("strh") + 8 + 20;  // scale, rate
  const std::vector<std::string> nothing;
  const auto notes = [&](bool has_time, bool has_rate) {
    std::string file = whole;
    if (!has_time) set_number(file, frame_time, 0);
    if (!has_rate) set_number(file, rate + 4, 0);
    VideoSource source(folder.write("drive.avi", file), false);
    Frame frame;
    EXPECT_EQ(source.grab(frame), Grab::frame);
    EXPECT_EQ(source.grab(frame), Grab::frame);
    EXPECT_NEAR(frame.time_s, has_time || has_rate ? 0.05 : 0.04, 1e-6);
    return source.notes();
  };
  EXPECT_EQ(notes(true, true), nothing);
  EXPECT_EQ(notes(true, false), nothing);
  EXPECT_EQ(notes(false, true), nothing);
  const std::vector<std::string> told = notes(false, false);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(says(told[0], "does not say its frame rate: it is taken for 25 frames a second"));
  std::string bare;  // JPEG pictures one behind the other
  for (std::uint64_t i = 0; i < 5; ++i)
    bare += test::encoded(test::textured(64, 48, i + 1), ".jpg");
  VideoSource source(folder.write("drive.mjpeg", bare), false);
  EXPECT_EQ(source.notes().size(), 1U);
}

// Bad input: everything that is no video.
TEST_F(VideoSourceTest, RefusesWhatIsNoVideo) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(make_video(folder));
  const std::string headers = whole.substr(0, whole.find("movi") + 4);
  EXPECT_TRUE(says(open_error(folder.path() / "none.mp4"), "does not exist"));
  EXPECT_TRUE(says(open_error(folder.path()), "is not a file"));
  EXPECT_TRUE(says(open_error(folder.write("text.mp4", "hello")), "is not a video"));
  EXPECT_TRUE(says(open_error(folder.write("empty.avi", "")), "is not a video"));
  EXPECT_FALSE(open_error(folder.write("headers.avi", headers)).empty());
}

}  // namespace
}  // namespace seqloop::opencv
