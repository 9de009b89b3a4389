// SPDX-License-Identifier: MIT
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "guarded_bytes.hpp"
#include "platform/jpegs.hpp"
#include "seqloop/turbojpeg/encode_jpeg.hpp"

namespace seqloop::turbojpeg {
namespace {

using test::Bytes;
using test::data_begin;
using test::jpeg_of;
using test::mjpg;
using test::segment;
using test::textured;
using test::without_tables;

constexpr PictureNeeds gray{.gray_is_enough = true};
constexpr PictureNeeds colour{};

/// A copy of what the decoder makes of it.
cv::Mat decoded(MjpgDecoder& decoder, const Bytes& jpeg, int width, int height) {
  Image image;
  EXPECT_EQ(decoder.decode(mjpg(jpeg, width, height), image), "");
  if (image.data == nullptr) return {};
  const int type = image.format == PixelFormat::gray8 ? CV_8UC1 : CV_8UC3;
  return cv::Mat(image.height, image.width, type, const_cast<std::uint8_t*>(image.data),
                 image.stride)
      .clone();
}

std::string fault_of(const Bytes& jpeg, int width, int height, const PictureNeeds& needs = gray) {
  MjpgDecoder decoder(needs);
  Image image;
  std::string fault(decoder.decode(mjpg(jpeg, width, height), image));
  EXPECT_EQ(image.data == nullptr, !fault.empty());
  return fault;
}

void expect_fault(const Bytes& jpeg, int width, int height, const std::string& part) {
  const std::string fault = fault_of(jpeg, width, height);
  EXPECT_NE(fault.find(part), std::string::npos) << "'" << fault << "' lacks '" << part << "'";
}

void insert(Bytes& bytes, std::size_t place, std::size_t count, std::uint8_t value) {
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place), count, value);
}

TEST(MjpgDecoder, DecodesAsOpenCvDoesAtFullSize) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(17, 9), std::pair(160, 120)}) {
    const Bytes jpeg = jpeg_of(textured(width, height));
    MjpgDecoder for_gray(gray);
    MjpgDecoder for_colour(colour);
    EXPECT_LE(cv::norm(decoded(for_gray, jpeg, width, height),
                       cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE), cv::NORM_INF),
              1.0);
    EXPECT_LE(cv::norm(decoded(for_colour, jpeg, width, height),
                       cv::imdecode(jpeg, cv::IMREAD_COLOR), cv::NORM_INF),
              2.0);
  }
}

TEST(MjpgDecoder, GrayPicturesComeInWhatIsWanted) {
  const Bytes jpeg = jpeg_of(textured(32, 24, 1, CV_8UC1));
  MjpgDecoder for_gray(gray);
  MjpgDecoder for_colour(colour);
  EXPECT_EQ(decoded(for_gray, jpeg, 32, 24).channels(), 1);
  EXPECT_EQ(decoded(for_colour, jpeg, 32, 24).channels(), 3);
}

TEST(MjpgDecoder, TakesTheSmallestSizeThatIsLargeEnoughBothWays) {
  struct Case {
    int width, height, needed_width, needed_height, decoded_width, decoded_height;
  };
  for (const Case& each :
       {Case{640, 480, 128, 64, 160, 120}, Case{640, 480, 80, 60, 80, 60},
        Case{640, 480, 81, 60, 160, 120}, Case{640, 480, 80, 61, 160, 120},
        Case{640, 480, 640, 480, 640, 480}, Case{640, 480, 227, 227, 320, 240},
        Case{640, 480, 321, 10, 640, 480}, Case{640, 480, 1000, 10, 640, 480},
        Case{640, 480, 0, 0, 640, 480}, Case{100, 75, 1, 1, 13, 10}, Case{7, 5, 1, 1, 1, 1}}) {
    MjpgDecoder decoder(
        {.width = each.needed_width, .height = each.needed_height, .gray_is_enough = true});
    const cv::Mat picture =
        decoded(decoder, jpeg_of(textured(each.width, each.height)), each.width, each.height);
    EXPECT_EQ(picture.cols, each.decoded_width) << each.needed_width << "x" << each.needed_height;
    EXPECT_EQ(picture.rows, each.decoded_height) << each.needed_width << "x" << each.needed_height;
  }
}

TEST(MjpgDecoder, AReducedPictureIsTheFullOneAveraged) {
  const Bytes jpeg = jpeg_of(textured(640, 480), {cv::IMWRITE_JPEG_QUALITY, 90});
  for (const PictureNeeds& needs : {gray, colour}) {
    MjpgDecoder full(needs);
    const cv::Mat whole = decoded(full, jpeg, 640, 480);
    for (const int eighths : {1, 2, 4}) {
      const cv::Size size(80 * eighths, 60 * eighths);
      MjpgDecoder reduced(
          {.width = size.width, .height = size.height, .gray_is_enough = needs.gray_is_enough});
      const cv::Mat picture = decoded(reduced, jpeg, 640, 480);
      ASSERT_EQ(picture.size(), size);
      cv::Mat averaged;
      cv::resize(whole, averaged, size, 0.0, 0.0, cv::INTER_AREA);
      const double pixels = static_cast<double>(averaged.total()) * averaged.channels();
      EXPECT_LE(cv::norm(picture, averaged, cv::NORM_L1) / pixels, 6.0) << eighths;
    }
  }
}

TEST(MjpgDecoder, FramesWithoutHuffmanTablesHaveTheStandardOnes) {
  const Bytes whole = jpeg_of(textured(64, 48));
  const Bytes stripped = without_tables(whole);
  ASSERT_LT(stripped.size() + 400, whole.size());
  MjpgDecoder decoder(colour);
  const cv::Mat expected = decoded(decoder, whole, 64, 48);
  EXPECT_EQ(cv::norm(decoded(decoder, stripped, 64, 48), expected, cv::NORM_INF), 0.0);
}

TEST(MjpgDecoder, AFrameIsDecodedTheSameWhateverCameBefore) {
  const cv::Mat picture = textured(64, 48);
  const Bytes stripped = without_tables(jpeg_of(picture));
  MjpgDecoder fresh(gray);
  const cv::Mat expected = decoded(fresh, stripped, 64, 48);
  MjpgDecoder used(gray);
  // Tables of its own, and then damage.
  static_cast<void>(decoded(used, jpeg_of(picture, {cv::IMWRITE_JPEG_OPTIMIZE, 1}), 64, 48));
  Bytes broken = jpeg_of(picture);
  broken.resize(broken.size() / 2);
  Image image;
  EXPECT_NE(used.decode(mjpg(broken, 64, 48), image), "");
  EXPECT_EQ(cv::norm(decoded(used, stripped, 64, 48), expected, cv::NORM_INF), 0.0);
  // Quantisation tables are not taken from another frame either.
  Bytes without_scale = jpeg_of(picture);
  for (std::size_t at = segment(without_scale, 0xdb); at < without_scale.size();
       at = segment(without_scale, 0xdb)) {
    const auto begin = without_scale.begin();
    without_scale.erase(begin + static_cast<std::ptrdiff_t>(at),
                        begin + static_cast<std::ptrdiff_t>(test::segment_end(without_scale, at)));
  }
  EXPECT_NE(used.decode(mjpg(without_scale, 64, 48), image), "");
}

TEST(MjpgDecoder, RestartMarkersAreNoDamage) {
  const Bytes jpeg = jpeg_of(textured(64, 48), {cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  EXPECT_EQ(fault_of(jpeg, 64, 48), "");
}

TEST(MjpgDecoder, PaddingIsNoDamage) {
  const Bytes jpeg = jpeg_of(textured(64, 48));
  for (const std::size_t count : {1U, 2U, 3U, 4U, 100U, 100'000U}) {
    for (const int value : {0x00, 0xff, 0x55}) {
      Bytes behind = jpeg;
      insert(behind, behind.size(), count, static_cast<std::uint8_t>(value));
      EXPECT_EQ(fault_of(behind, 64, 48), "") << count;
      if (count > 4) continue;
      Bytes before = jpeg;
      insert(before, before.size() - 2, count, static_cast<std::uint8_t>(value));
      EXPECT_EQ(fault_of(before, 64, 48), "") << count << " before the end";
    }
  }
  Bytes much = jpeg;
  insert(much, much.size() - 2, 100, 0);
  expect_fault(much, 64, 48, "extraneous bytes before marker 0xd9");
}

TEST(MjpgDecoder, OddHeadersAreNoDamageAndHideNone) {
  const Bytes jpeg = test::with_odd_header(jpeg_of(textured(64, 48)));
  EXPECT_EQ(fault_of(jpeg, 64, 48), "");
  Bytes ended = jpeg;
  ended.at((data_begin(jpeg) + jpeg.size()) / 2) = 0xff;
  ended.at((data_begin(jpeg) + jpeg.size()) / 2 + 1) = 0xd9;
  expect_fault(ended, 64, 48, "damaged (Corrupt JPEG data");
}

TEST(MjpgDecoder, EveryTruncationIsAFault) {
  const Bytes jpeg = jpeg_of(textured(40, 24));
  for (std::size_t size = 0; size < jpeg.size(); ++size) {
    const Bytes cut(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_NE(fault_of(cut, 40, 24), "") << size << " of " << jpeg.size() << " bytes";
    Bytes padded = cut;  // drivers hand over buffers of a fixed size
    padded.resize(jpeg.size() + 100);
    if (size + 2 < jpeg.size()) {
      ASSERT_NE(fault_of(padded, 40, 24), "") << size << " of " << jpeg.size() << " bytes, padded";
    }
  }
}

TEST(MjpgDecoder, WhatIsWrongIsSaid) {
  const Bytes jpeg = jpeg_of(textured(64, 48));
  expect_fault({}, 64, 48, "the frame is empty");
  expect_fault(Bytes(5000, 0), 64, 48, "does not begin with FF D8");
  expect_fault({jpeg.begin() + 2, jpeg.end()}, 64, 48, "does not begin with FF D8");
  expect_fault({jpeg.begin(), jpeg.begin() + 100}, 64, 48, "ends before its data");
  expect_fault({jpeg.begin(), jpeg.end() - 100}, 64, 48, "Premature end of JPEG file");
  expect_fault(jpeg, 320, 240, "is 64x48, but 320x240 was declared");
  expect_fault(jpeg, 48, 64, "is 64x48, but 48x64 was declared");
  expect_fault(jpeg, -1, 48, "is 64x48, but 0x48 was declared");
  expect_fault(jpeg_of(textured(64, 48), {cv::IMWRITE_JPEG_PROGRESSIVE, 1}), 64, 48, "progressive");

  const std::size_t frame = segment(jpeg, 0xc0);
  const auto changed = [&](std::size_t place, std::uint8_t value) {
    Bytes bytes = jpeg;
    bytes.at(place) = value;
    return bytes;
  };
  expect_fault(changed(frame + 4, 12), 64, 48, "8 bits");
  expect_fault(changed(frame + 5, 0xff), 64, 48, "is 64x65328, but 64x48 was declared");
  expect_fault(changed(frame + 6, 0), 64, 48, "does not say its size");
  expect_fault(changed(frame + 9, 4), 64, 48, "three colours");
  expect_fault(changed(frame + 1, 0xc9), 64, 48, "arithmetically");
  expect_fault(changed(frame, 0), 64, 48, "damaged before its data begin");
  expect_fault(changed(segment(jpeg, 0xda) + 4, 1), 64, 48, "one by one");
  Bytes enormous = changed(frame + 5, 0xff);
  enormous.at(frame + 7) = 0xff;
  expect_fault(enormous, 0xff40, 0xff30, "200 million");

  MjpgDecoder decoder(gray);
  Image image;
  EXPECT_EQ(decoder.decode({jpeg, 64, 48, 128, RawFormat::yuyv}, image),
            "the frame is YUYV, not MJPG");
}

TEST(MjpgDecoder, FourColoursAreRefused) {
  const std::unique_ptr<void, decltype(&tjDestroy)> compressor(tjInitCompress(), &tjDestroy);
  const Bytes inks(std::size_t{64} * 48 * 4, 100);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(compressor.get(), inks.data(), 64, 0, 48, TJPF_CMYK, &memory, &size,
                        TJSAMP_444, 90, 0),
            0);
  const Bytes jpeg(memory, memory + size);
  tjFree(memory);
  expect_fault(jpeg, 64, 48, "three colours");
}

TEST(MjpgDecoder, BrokenDataAreAFault) {
  const Bytes jpeg = jpeg_of(textured(64, 48));
  const std::size_t begin = data_begin(jpeg);
  const std::size_t middle = (begin + jpeg.size()) / 2;
  Bytes ended = jpeg;  // an end in the middle
  ended[middle] = 0xff;
  ended[middle + 1] = 0xd9;
  expect_fault(ended, 64, 48, "damaged (");
  Bytes twice = jpeg;  // a second scan, and a second picture in the first one's data
  twice.insert(twice.end() - 2, jpeg.begin() + static_cast<std::ptrdiff_t>(segment(jpeg, 0xda)),
               jpeg.end() - 2);
  expect_fault(twice, 64, 48, "damaged (");
}

TEST(MjpgDecoder, LostPacketsAreAFault) {
  const Bytes jpeg = jpeg_of(textured(320, 240));
  constexpr std::size_t packet = 3000;
  for (std::size_t at = data_begin(jpeg); at + packet + 2 < jpeg.size(); at += 1000) {
    Bytes hole = jpeg;
    const auto begin = hole.begin() + static_cast<std::ptrdiff_t>(at);
    hole.erase(begin, begin + packet);
    EXPECT_NE(fault_of(hole, 320, 240), "") << at;
  }
}

TEST(MjpgDecoder, NothingIsWrittenToTheTerminal) {
  Bytes jpeg = jpeg_of(textured(64, 48));
  jpeg.resize(jpeg.size() - 200);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_NE(fault_of(jpeg, 64, 48), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(EncodeJpeg, MakesNothingOfAFormatThatIsNone) {
  const Bytes pixels(12, 100);
  EXPECT_FALSE(encode_jpeg({pixels.data(), 2, 2, 6, PixelFormat::bgr8}, 90).empty());
  EXPECT_TRUE(encode_jpeg({pixels.data(), 2, 2, 6, PixelFormat{77}}, 90).empty());
}

TEST(MjpgDecoder, ASizeAgreedToAnewIsTaken) {
  MjpgDecoder decoder({.width = 16, .height = 16, .gray_is_enough = true});
  EXPECT_EQ(decoded(decoder, jpeg_of(textured(64, 48)), 64, 48).cols, 32);
  EXPECT_EQ(decoded(decoder, jpeg_of(textured(320, 240)), 320, 240).cols, 40);
  EXPECT_EQ(decoded(decoder, jpeg_of(textured(64, 48)), 64, 48).cols, 32);
}

/// Any bytes at all: a picture of the right size or a fault, and nothing read behind the bytes.
class Fuzz {
 public:
  explicit Fuzz(std::uint32_t seed) : random_(seed), seed_(seed) {}
  ~Fuzz() {
    std::printf("seed %u: %zu taken, %zu refused, sum %llu\n", seed_, taken_, refused_,
                static_cast<unsigned long long>(sum_));
  }
  Fuzz(const Fuzz&) = delete;
  Fuzz& operator=(const Fuzz&) = delete;
  Fuzz(Fuzz&&) = delete;
  Fuzz& operator=(Fuzz&&) = delete;

  std::size_t below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }
  std::mt19937& random() { return random_; }

  void try_one(const Bytes& bytes) {
    const bool reduces = below(2) == 0;
    MjpgDecoder& decoder = reduces ? reduced_ : full_;
    Image image;
    if (!decoder.decode(mjpg(memory_.hold(bytes), width, height), image).empty()) {
      ++refused_;
      return;
    }
    ++taken_;
    ASSERT_EQ(image.width, reduces ? (width + 1) / 2 : width);
    ASSERT_EQ(image.height, reduces ? (height + 1) / 2 : height);
    for (std::size_t i = 0; i < image.stride * static_cast<std::size_t>(image.height); ++i)
      sum_ += image.data[i];
  }

  [[nodiscard]] std::size_t taken() const { return taken_; }
  [[nodiscard]] std::size_t refused() const { return refused_; }

  static constexpr int width = 40;
  static constexpr int height = 24;

 private:
  std::mt19937 random_;
  std::uint32_t seed_;
  test::GuardedBytes memory_{1 << 16};
  MjpgDecoder full_{colour};
  MjpgDecoder reduced_{{.width = width / 2, .height = height / 2, .gray_is_enough = true}};
  std::size_t taken_ = 0;
  std::size_t refused_ = 0;
  std::uint64_t sum_ = 0;
};

constexpr int rounds = 22'000;

/// Pictures as cameras make them.
std::vector<Bytes> seeds_of_fuzz() {
  const cv::Mat picture = textured(Fuzz::width, Fuzz::height);
  return {jpeg_of(picture), without_tables(jpeg_of(picture)),
          jpeg_of(picture, {cv::IMWRITE_JPEG_RST_INTERVAL, 1}),
          jpeg_of(picture, {cv::IMWRITE_JPEG_OPTIMIZE, 1}),
          jpeg_of(textured(Fuzz::width, Fuzz::height, 2, CV_8UC1))};
}

TEST(MjpgDecoderFuzz, RandomBytes) {
  Fuzz fuzz(21);
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes(fuzz.below(2000));
    std::ranges::generate(bytes, [&] { return fuzz.byte(); });
    if (bytes.size() > 2 && fuzz.below(4) != 0) bytes[0] = 0xff, bytes[1] = 0xd8;
    fuzz.try_one(bytes);
  }
  EXPECT_EQ(fuzz.taken(), 0U);
}

TEST(MjpgDecoderFuzz, RandomTruncations) {
  Fuzz fuzz(22);
  const std::vector<Bytes> seeds = seeds_of_fuzz();
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = seeds.at(fuzz.below(seeds.size()));
    bytes.resize(fuzz.below(bytes.size()));
    if (fuzz.below(2) == 0) insert(bytes, bytes.size(), fuzz.below(500), 0);
    fuzz.try_one(bytes);
  }
  EXPECT_EQ(fuzz.taken(), 0U);
}

TEST(MjpgDecoderFuzz, RandomBitFlips) {
  Fuzz fuzz(23);
  const std::vector<Bytes> seeds = seeds_of_fuzz();
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = seeds.at(fuzz.below(seeds.size()));
    for (std::size_t flips = 1 + fuzz.below(8); flips > 0; --flips)
      bytes[fuzz.below(bytes.size())] ^= static_cast<std::uint8_t>(1U << fuzz.below(8));
    fuzz.try_one(bytes);
  }
  EXPECT_GT(fuzz.taken(), 1'000U);
  EXPECT_GT(fuzz.refused(), 1'000U);
}

TEST(MjpgDecoderFuzz, RandomHeaders) {
  Fuzz fuzz(24);
  const std::vector<Bytes> seeds = seeds_of_fuzz();
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = seeds.at(fuzz.below(seeds.size()));
    const std::size_t header = data_begin(bytes);
    for (std::size_t changes = 1 + fuzz.below(4); changes > 0; --changes) {
      const std::size_t place = 2 + fuzz.below(header - 2);
      switch (fuzz.below(4)) {
        case 0:
          insert(bytes, place, 1 + fuzz.below(4), fuzz.byte());
          break;
        case 1:
          bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(place));
          break;
        default:
          bytes[place] = fuzz.byte();
      }
    }
    fuzz.try_one(bytes);
  }
  EXPECT_GT(fuzz.taken(), 1'000U);
  EXPECT_GT(fuzz.refused(), 1'000U);
}

}  // namespace
}  // namespace seqloop::turbojpeg
