// SPDX-License-Identifier: MIT
#include "opencv/detail/avi_pictures.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "platform/pictures.hpp"
#include "temporary_folder.hpp"

namespace seqloop::opencv {
namespace {

std::string number(std::uint32_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}

std::string chunk(const std::string& name, const std::string& content) {
  return name + number(static_cast<std::uint32_t>(content.size())) + content +
         (content.size() % 2 == 0 ? "" : std::string(1, '\0'));
}

std::string list(const std::string& name, const std::string& content) {
  return chunk("LIST", name + content);
}

/// @param time scale, rate, start and length
std::string stream(const std::string& kind, const std::string& codec,
                   const std::string& time = std::string(16, '\0')) {
  const std::string format = number(40) + number(64) + number(48) + number(0) + codec;
  const std::string header = kind + codec + std::string(12, '\0') + time + std::string(20, '\0');
  return list("strl", chunk("strh", header) + chunk("strf", format + std::string(20, '\0')));
}

/// @param movi what stands where the pictures are
std::string avi(const std::string& streams, const std::string& movi, std::uint32_t frame_us = 0) {
  const std::string main = number(frame_us) + std::string(52, '\0');
  return chunk("RIFF", "AVI " + list("hdrl", chunk("avih", main) + streams) + chunk("JUNK", "odd") +
                           list("movi", movi));
}

/// What is read: number and bytes of each picture; nothing where the file is not taken.
using Read = std::vector<std::pair<std::uint64_t, std::string>>;
std::optional<Read> read(const std::string& file) {
  const test::TemporaryFolder folder;
  const std::vector<std::uint8_t> head(file.begin(), file.end());
  const auto header = read_avi_header(head);
  if (!header || !header->motion_jpeg) return std::nullopt;
  EXPECT_EQ(std::pair(header->width, header->height), std::pair(64, 48));
  AviPictures pictures(folder.write("drive.avi", file), *header);
  Read read;
  std::vector<std::uint8_t> jpeg;
  while (pictures.next(jpeg))
    read.emplace_back(pictures.number(), std::string(jpeg.begin(), jpeg.end()));
  EXPECT_FALSE(pictures.next(jpeg));
  return read;
}

const std::string video = stream("vids", "MJPG");
const std::string sound = stream("auds", "\1\0\0\0");

std::optional<AviHeader> header_of(const std::string& file) {
  return read_avi_header(std::vector<std::uint8_t>(file.begin(), file.end()));
}

TEST(AviHeader, TellsTheRateAndTheLengthOfTheFirstVideo) {
  const std::string time = number(1001) + number(30'000) + number(7) + number(12);
  const std::string other = stream("vids", "MJPG", number(1) + number(5) + number(0) + number(99));
  for (const char* codec : {"MJPG", "H264"}) {
    const auto header = header_of(avi(sound + stream("vids", codec, time) + other, "", 50'000));
    ASSERT_TRUE(header);
    EXPECT_EQ(header->stream, 1);
    EXPECT_EQ(header->motion_jpeg, codec == std::string("MJPG"));
    EXPECT_EQ(header->rate, 30'000.0 / 1001.0);
    EXPECT_EQ(header->frames, 12U);
  }
}

TEST(AviHeader, HasTheRateOfTheMainHeaderWhereTheVideosOwnIsNone) {
  for (const std::string& time : {number(1) + number(0), number(0) + number(25)}) {
    const std::string untold = stream("vids", "MJPG", time + std::string(8, '\0'));
    EXPECT_EQ(header_of(avi(untold, "", 50'000)).value_or(AviHeader{}).rate, 20.0);
    EXPECT_EQ(header_of(avi(untold, "")).value_or(AviHeader{.rate = 1.0}).rate, 0.0);
  }
}

TEST(AviPictures, AreReadInTheirOrderWithTheirNumbers) {
  const std::string movi = chunk("00dc", "first") + chunk("01wb", "sound!") + chunk("00db", "2nd") +
                           chunk("00dc", "") + chunk("ix00", "index") + chunk("00dc", "fourth");
  const Read expected{{0, "first"}, {1, "2nd"}, {3, "fourth"}};
  EXPECT_EQ(read(avi(video + sound, movi)), expected);
  EXPECT_EQ(read(avi(video, list("rec ", movi)) + chunk("idx1", "00dc")), expected);
}

TEST(AviPictures, MayBeOfASecondStreamAndInALaterPart) {
  const std::string movi = chunk("01dc", "first") + chunk("00dc", "another stream's");
  const std::string more = chunk("RIFF", "AVIX" + list("movi", chunk("01dc", "second")));
  EXPECT_EQ(read(avi(sound + video, movi) + more), (Read{{0, "first"}, {1, "second"}}));
}

// A recorder that lost its power wrote no lengths of its lists.
TEST(AviPictures, AreReadAsFarAsACutFileGoes) {
  std::string file = avi(video, chunk("00dc", "first") + chunk("00dc", "second"));
  for (const char* name : {"RIFF", "movi"}) {
    const std::size_t length = file.rfind(name) + 4 - (name[0] == 'm' ? 8 : 0);
    file.replace(length, 4, number(0));
  }
  EXPECT_EQ(read(file), (Read{{0, "first"}, {1, "second"}}));
  file.pop_back();
  EXPECT_EQ(read(file), (Read{{0, "first"}}));
  EXPECT_EQ(read(file.substr(0, file.find("movi") + 4)), Read());
}

TEST(AviPictures, AreOfMotionJpegAlone) {
  const std::string movi = chunk("00dc", "first");
  EXPECT_FALSE(read(avi(stream("vids", "H264"), movi)));
  EXPECT_FALSE(read(avi(sound, movi)));
  EXPECT_FALSE(read("RIFF"));
  EXPECT_FALSE(read(""));
  std::string endless = avi(video, movi);
  endless.replace(endless.find("strf") + 8 + 4, 4, number(1U << 31U));
  EXPECT_FALSE(read(endless));
}

// Bad input: whatever is changed, reading ends, and no picture is longer than the file.
TEST(AviPictures, EndWhateverIsDamaged) {
  constexpr unsigned seed = 19;
  std::cout << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const test::TemporaryFolder folder;
  const std::string whole =
      avi(video + sound, list("rec ", chunk("00dc", "first") + chunk("01wb", "sound")) +
                             chunk("00dc", "") + chunk("00dc", "second"));
  std::size_t taken = 0;
  for (int i = 0; i < 400; ++i) {
    const std::string file = test::mutated(whole, random);
    const std::vector<std::uint8_t> head(file.begin(), file.end());
    const auto header = read_avi_header(head);
    if (!header || !header->motion_jpeg) continue;
    AviPictures pictures(folder.write("drive.avi", file), *header);
    ++taken;
    std::vector<std::uint8_t> jpeg;
    std::size_t count = 0;
    while (pictures.next(jpeg)) {
      ASSERT_LE(jpeg.size(), file.size());
      ASSERT_LE(++count, file.size() / 8);
    }
  }
  EXPECT_GT(taken, 100U);
}

}  // namespace
}  // namespace seqloop::opencv
