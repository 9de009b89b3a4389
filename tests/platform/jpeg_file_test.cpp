// SPDX-License-Identifier: MIT
// JPEG files of a folder: what OpenCV would read, and damage that it does not tell.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <random>

#include "expect_setup_error.hpp"
#include "platform/jpegs.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/opencv/image_folder_source.hpp"
#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"

namespace seqloop {
namespace {

using opencv::ImageFolderSource;
using test::Bytes;
using test::jpeg_of;
using test::says;
using test::TemporaryFolder;
using test::textured;

std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

ImageFolderSource open(const TemporaryFolder& folder, bool gray = false) {
  return {folder.path(), gray, 10.0, std::make_unique<turbojpeg::JpegFileDecoder>(gray)};
}

/// What a folder with this one file brings; the fault where it is unreadable.
std::string fault_of(const Bytes& jpeg) {
  const TemporaryFolder folder;
  folder.write("a.jpg", text(jpeg));
  ImageFolderSource source = open(folder);
  Frame frame;
  return source.grab(frame) == Grab::frame ? "" : std::string(frame.fault);
}

/// Whatever OpenCV reads, a folder hands over: the same pixels.
void expect_as_opencv(const Bytes& jpeg, const std::string& what) {
  const TemporaryFolder folder;
  folder.write("a.jpg", text(jpeg));
  for (const bool gray : {false, true}) {
    SCOPED_TRACE(what + (gray ? ", grey" : ""));
    ImageFolderSource source = open(folder, gray);
    Frame frame;
    ASSERT_EQ(source.grab(frame), Grab::frame) << frame.fault;
    const cv::Mat wanted = cv::imdecode(jpeg, gray ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
    const cv::Mat got(frame.image.height, frame.image.width, gray ? CV_8UC1 : CV_8UC3,
                      const_cast<std::uint8_t*>(frame.image.data), frame.image.stride);
    ASSERT_EQ(got.size(), wanted.size());
    EXPECT_EQ(cv::norm(got, wanted, cv::NORM_INF), 0.0);
  }
}

/// With TurboJPEG's own settings. @param format of the bytes; flags and subsampling as it has them
Bytes compressed(const cv::Mat& picture, TJPF format, TJSAMP subsampling, int flags = 0) {
  const std::unique_ptr<void, decltype(&tjDestroy)> compressor(tjInitCompress(), &tjDestroy);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(
      tjCompress2(compressor.get(), picture.data, picture.cols, static_cast<int>(picture.step[0]),
                  picture.rows, format, &memory, &size, subsampling, 85, flags),
      0);
  Bytes jpeg(memory, memory + size);
  tjFree(memory);
  return jpeg;
}

/// With an EXIF segment that says how to turn the picture. @param type II or MM, the byte order
Bytes with_orientation(Bytes jpeg, int orientation, const std::string& type) {
  const bool little = type == "II";
  std::string exif = "Exif";
  exif += std::string(2, '\0') + type;
  const auto number = [&](std::size_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      exif += static_cast<char>(value >> 8 * (little ? i : bytes - 1 - i) & 0xff);
  };
  number(42, 2);
  number(8, 4);  // where the directory is
  number(2, 2);  // entries
  for (const auto& [tag, value] : {std::pair{0x0106, 1}, {0x0112, orientation}}) {
    number(static_cast<std::size_t>(tag), 2);
    number(3, 2);  // short
    number(1, 4);
    number(static_cast<std::size_t>(value), 2);
    number(0, 2);
  }
  number(0, 4);
  const std::size_t length = exif.size() + 2;
  const Bytes segment{0xff, 0xe1, static_cast<std::uint8_t>(length >> 8),
                      static_cast<std::uint8_t>(length)};
  jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

TEST(JpegFiles, ThePixelsAreOpenCvs) {
  for (const auto& [width, height] : {std::pair{64, 48}, {61, 47}, {1, 1}, {160, 120}}) {
    const cv::Mat picture = textured(width, height);
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    for (const TJSAMP subsampling :
         {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_440, TJSAMP_411, TJSAMP_GRAY}) {
      const Bytes jpeg = compressed(picture, TJPF_BGR, subsampling);
      expect_as_opencv(jpeg, size + ", subsampling " + std::to_string(subsampling));
      expect_as_opencv(compressed(picture, TJPF_BGR, subsampling, TJFLAG_PROGRESSIVE),
                       size + ", progressive " + std::to_string(subsampling));
    }
    expect_as_opencv(jpeg_of(textured(width, height, 2, CV_8UC1)), size + ", grey");
    expect_as_opencv(jpeg_of(picture, {cv::IMWRITE_JPEG_RST_INTERVAL, 1}), size + ", restarts");
    expect_as_opencv(jpeg_of(picture, {cv::IMWRITE_JPEG_OPTIMIZE, 1}), size + ", own tables");
    expect_as_opencv(test::without_tables(jpeg_of(picture)), size + ", without tables");
    cv::Mat inks(height, width, CV_8UC4, cv::Scalar(10, 90, 170, 250));
    expect_as_opencv(compressed(inks, TJPF_CMYK, TJSAMP_444), size + ", four inks");
  }
}

TEST(JpegFiles, AreTurnedAsOpenCvTurnsThem) {
  const Bytes jpeg = jpeg_of(textured(37, 20));
  for (const std::string type : {"II", "MM"}) {
    for (int orientation = 0; orientation <= 9; ++orientation)
      expect_as_opencv(with_orientation(jpeg, orientation, type),
                       type + std::to_string(orientation));
  }
  Bytes sideways = with_orientation(jpeg, 6, "II");
  EXPECT_EQ(cv::imdecode(sideways, cv::IMREAD_COLOR).cols, 20) << "the test turns pictures";
  Bytes twice = with_orientation(with_orientation(jpeg, 6, "II"), 1, "MM");
  expect_as_opencv(twice, "the first segment counts");
  sideways.resize(40);
  EXPECT_TRUE(says(fault_of(sideways), "truncated"));
}

// As phones and editors write them. OpenCV 4.6 looks at the first segment alone.
TEST(JpegFiles, AreTurnedWhereOtherDataStandsBeforeExif) {
  Bytes sideways = with_orientation(jpeg_of(textured(37, 20)), 6, "II");
  const std::string xmp = "http://ns.adobe.com/xap/1.0/";
  sideways.insert(sideways.begin() + 2, xmp.begin(), xmp.end());
  sideways.insert(sideways.begin() + 2, {0xff, 0xe1, 0, static_cast<std::uint8_t>(xmp.size() + 2)});
  const TemporaryFolder folder;
  folder.write("a.jpg", text(sideways));
  ImageFolderSource source = open(folder);
  Frame frame;
  ASSERT_EQ(source.grab(frame), Grab::frame) << frame.fault;
  EXPECT_EQ(std::pair(frame.image.width, frame.image.height), std::pair(20, 37));
}

TEST(JpegFiles, DamageInTheMiddleIsAFault) {
  constexpr unsigned seed = 5;
  std::mt19937 random(seed);
  int seen = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
      Bytes jpeg = compressed(textured(160, 120, i + 1), TJPF_BGR, TJSAMP_420, flags);
      for (std::size_t k = 0; k < 100; ++k)
        jpeg[jpeg.size() / 2 + k] = static_cast<std::uint8_t>(random());
      const std::string fault = fault_of(jpeg);
      if (fault.empty()) continue;  // all of them valid codes, and as many blocks as before
      EXPECT_TRUE(says(fault, "a.jpg: the JPEG picture is damaged ("));
      ++seen;
    }
  }
  std::printf("seed %u: the damage in %d of 200 pictures is seen\n", seed, seen);
  EXPECT_GT(seen, 140);
}

TEST(JpegFiles, DamageIsSeenBetweenGoodFrames) {
  const Bytes good = jpeg_of(textured(160, 120));
  Bytes bad = good;
  bad.erase(bad.begin() + static_cast<std::ptrdiff_t>(bad.size() / 2),
            bad.begin() + static_cast<std::ptrdiff_t>(bad.size() / 2 + 100));
  const TemporaryFolder folder;
  for (const char* name : {"0.jpg", "2.jpg"}) folder.write(name, text(good));
  folder.write("1.jpg", text(bad));
  ImageFolderSource source = open(folder);
  testing::internal::CaptureStderr();
  Frame frame;
  EXPECT_EQ(source.grab(frame), Grab::frame);
  const std::vector<std::uint8_t> first(frame.image.data, frame.image.data + 160 * 120 * 3);
  EXPECT_EQ(source.grab(frame), Grab::unreadable);
  EXPECT_TRUE(says(std::string(frame.fault), "1.jpg: the JPEG picture is damaged"));
  EXPECT_EQ(frame.image.data, nullptr);
  EXPECT_EQ(source.grab(frame), Grab::frame);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), frame.image.data));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  // Without a decoder of its own, OpenCV makes the rest up.
  ImageFolderSource plain(folder.path(), false);
  EXPECT_EQ(plain.grab(frame), Grab::frame);
  testing::internal::CaptureStderr();
  EXPECT_EQ(plain.grab(frame), Grab::frame);
  static_cast<void>(testing::internal::GetCapturedStderr());
}

TEST(JpegFiles, WhatIsHarmlessIsNoDamage) {
  const Bytes jpeg = jpeg_of(textured(64, 48));
  Bytes padded = jpeg;
  padded.insert(padded.end() - 2, 4, 0);
  EXPECT_EQ(fault_of(padded), "");
  padded.insert(padded.end() - 2, 100, 0);
  EXPECT_TRUE(says(fault_of(padded), "extraneous bytes before marker 0xd9"));
  Bytes behind = jpeg;
  behind.insert(behind.end(), 1000, 0x55);
  EXPECT_EQ(fault_of(behind), "");
  expect_as_opencv(test::with_odd_header(jpeg), "with a header that is odd");
}

/// A progressive picture of one grey block: a scan of its brightness, then again and again one of
/// all else, which is nothing.
Bytes with_scans(int scans) {
  Bytes jpeg;
  const auto add = [&jpeg](std::initializer_list<std::uint8_t> bytes, int more = 0,
                           std::uint8_t what = 0) {
    for (const std::uint8_t byte : bytes) jpeg.push_back(byte);
    for (int i = 0; i < more; ++i) jpeg.push_back(what);
  };
  add({0xff, 0xd8, 0xff, 0xdb, 0, 67, 0}, 64, 1);
  add({0xff, 0xc2, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0});
  add({0xff, 0xc4, 0, 20, 0x00, 1}, 16);  // one code: no bits follow
  add({0xff, 0xc4, 0, 20, 0x10, 1}, 16);
  add({0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0, 0x7f});
  for (int i = 1; i < scans; ++i) add({0xff, 0xda, 0, 8, 1, 1, 0, 1, 63, 0, 0x7f});
  add({0xff, 0xd9});
  return jpeg;
}

TEST(JpegFiles, MoreScansThanAnyEncoderWritesAreRefused) {
  expect_as_opencv(with_scans(64), "64 scans");
  const std::string fault =
      "a.jpg: the JPEG picture has more than 64 scans, which take too long to decode; encode it "
      "anew";
  EXPECT_EQ(fault_of(with_scans(65)), fault);
  Bytes hidden = with_scans(65);
  hidden.insert(hidden.begin() + static_cast<std::ptrdiff_t>(test::segment(hidden, 0xc2)), 0);
  EXPECT_EQ(fault_of(hidden), fault) << "libjpeg skips bytes between segments";
  // Neither in a segment nor behind the end is it a scan.
  Bytes others = with_scans(64);
  others.insert(others.end(), {0xff, 0xda, 0, 8, 0xff, 0xd9});
  others.insert(others.begin() + 2, {0xff, 0xfe, 0, 4, 0xff, 0xda});
  EXPECT_EQ(fault_of(others), "");
  // With OpenCV's decoder, too.
  const TemporaryFolder folder;
  folder.write("a.jpg", text(with_scans(65)));
  ImageFolderSource plain(folder.path(), false);
  Frame frame;
  EXPECT_EQ(plain.grab(frame), Grab::unreadable);
  EXPECT_EQ(frame.fault, fault);
}

TEST(JpegFiles, TheDecoderAloneBoundsScansToo) {
  turbojpeg::JpegFileDecoder decoder(false);
  Image image;
  const Bytes jpeg = with_scans(600);
  EXPECT_TRUE(says(std::string(decoder.decode({.bytes = jpeg}, image)), "more than 500 scans"));
}

TEST(JpegFiles, MutatedOnesAreReadOrRefused) {
  constexpr unsigned seed = 4;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const TemporaryFolder folder;
  const std::string good = text(with_orientation(jpeg_of(textured(32, 24)), 6, "MM"));
  for (int i = 0; i < 600; ++i)
    folder.write(std::to_string(i) + ".jpg", test::mutated(good, random));
  ImageFolderSource source = open(folder);
  int unreadable = 0;
  Frame frame;
  for (Grab grab = source.grab(frame); grab != Grab::end; grab = source.grab(frame)) {
    if (grab == Grab::frame) {
      EXPECT_GT(frame.image.width * frame.image.height, 0);
    } else {
      ++unreadable;
      EXPECT_FALSE(frame.fault.empty());
    }
  }
  EXPECT_GT(unreadable, 200);
  EXPECT_LT(unreadable, 600);
}

/// Bytes of address space that this process has.
std::size_t address_space() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// What is said in a process that can take only a few bytes more.
template <class Work>
std::string said_with_memory(std::size_t more, Work work) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const rlim_t most = address_space() + more;
    const rlimit limit{most, most};
    if (::setrlimit(RLIMIT_AS, &limit) == 0) folder.write("said", work());
    ::_exit(0);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return test::read_all(folder.path() / "said");
}

/// The fault of a folder's only frame where it cannot have 400 MB.
std::string fault_when_short_of_memory(const std::string& name, const std::string& content) {
  const TemporaryFolder drive;
  drive.write(name, content);
  ImageFolderSource source = open(drive);
  return said_with_memory(std::size_t{400} << 20, [&] {
    Frame frame;
    return source.grab(frame) == Grab::unreadable ? std::string(frame.fault) : "";
  });
}

TEST(PictureFiles, TooLittleMemoryIsSaidWithTheSize) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more address space than a limit would leave";
#endif
  Bytes jpeg = jpeg_of(textured(8, 8));
  const std::size_t frame = test::segment(jpeg, 0xc0);
  for (const std::size_t at : {frame + 5, frame + 7}) {
    jpeg.at(at) = 13'000 >> 8;
    jpeg.at(at + 1) = 13'000 & 0xff;
  }
  EXPECT_EQ(fault_when_short_of_memory("a.jpg", text(jpeg)),
            "a.jpg: there is not enough memory for a picture of 13000x13000");
  const cv::Mat white(13'000, 13'000, CV_8UC1, cv::Scalar(255));
  Bytes png;
  cv::imencode(".png", white, png, {cv::IMWRITE_PNG_BILEVEL, 1});
  EXPECT_EQ(fault_when_short_of_memory("a.png", text(png)),
            "a.png: there is not enough memory for a picture of 13000x13000");
  const std::string fault = fault_when_short_of_memory("a.ppm", "P5 13000 13000 255\nxxxx");
  EXPECT_TRUE(says(fault, "a.ppm: there is not enough memory for the picture ("));
  EXPECT_TRUE(says(fault, "507000000 bytes"));
}

TEST(PictureFiles, TooLittleMemoryToDescribeThemIsSaidWithTheSize) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more address space than a limit would leave";
#endif
  const auto describer = opencv::make_builtin_describer();
  std::vector<float> descriptor(describer->size());
  const cv::Mat picture(13'000, 13'000, CV_8UC3);
  const std::string said = said_with_memory(std::size_t{50} << 20, [&] {
    return describer->describe(test::image_of(picture), descriptor) == Description::failed
               ? std::string(describer->last_fault())
               : "";
  });
  EXPECT_EQ(said, "there is not enough memory to describe a picture of 13000x13000");
}

}  // namespace
}  // namespace seqloop
