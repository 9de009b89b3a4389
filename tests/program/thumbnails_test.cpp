// SPDX-License-Identifier: MIT
// Thumbnails of places, made beside the loop.
#include "program/map/thumbnails.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/allocation_guard.hpp"

namespace seqloop::program {
namespace {

/// A drive's pictures, all of one size.
class Pictures {
 public:
  [[nodiscard]] Image image() const { return {pixels_.data(), 320, 200, 320, PixelFormat::gray8}; }

 private:
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(320 * 200, 7);
};

/// A hundred bytes a picture.
std::string encoded(const SmallPictureFacts& facts, std::span<const std::uint8_t> pixels,
                    int /*quality*/) {
  return pixels.size() >= facts.bytes() ? "\xFF\xD8" + std::string(98, '.') : "";
}

TEST(Thumbnails, AreMadeInOrderAndGoWhenTheyAreSaved) {
  const Pictures pictures;
  const auto thumbnails = std::make_unique<Thumbnails>(encoded);
  for (std::uint64_t place = 100; place < 200; place += 2) {
    thumbnails->add(pictures.image(), place);
  }
  thumbnails->add({}, 200);
  thumbnails->finish();
  EXPECT_EQ(thumbnails->missing(), 0U) << "a place without a picture misses none";
  EXPECT_TRUE(thumbnails->waiting(100, 10).empty()) << "its place is not saved yet";
  const auto first = thumbnails->waiting(105, 10);
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first[0].place, 100U);
  EXPECT_EQ(first[2].place, 104U);
  EXPECT_EQ(first[0].jpeg[0], std::byte{0xFF});
  EXPECT_EQ(first[0].jpeg[1], std::byte{0xD8});
  EXPECT_EQ(thumbnails->waiting(1000, 7).size(), 7U);
  thumbnails->saved(3);
  EXPECT_EQ(thumbnails->waiting(1000, 100).size(), 47U);
  EXPECT_EQ(thumbnails->waiting(1000, 100).front().place, 106U);
}

TEST(Thumbnails, WhatFindsNoRoomIsCounted) {
  const Pictures pictures;
  const auto thumbnails = std::make_unique<Thumbnails>(encoded, 5'000);
  for (std::uint64_t place = 0; place < 2'000; ++place) thumbnails->add(pictures.image(), place);
  thumbnails->finish();
  const auto waiting = thumbnails->waiting(2'000, 2'000);
  std::size_t bytes = 0;
  for (const auto& one : waiting) bytes += one.jpeg.size();
  EXPECT_FALSE(waiting.empty());
  EXPECT_LE(bytes, 5'000U);
  EXPECT_EQ(waiting.size() + thumbnails->missing(), 2'000U);
}

TEST(Thumbnails, AFrameTakesNoMemoryForOne) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
  const Pictures pictures;
  const auto thumbnails = std::make_unique<Thumbnails>(encoded);
  const AllocationGuard guard;
  for (std::uint64_t place = 0; place < 2'000; ++place) thumbnails->add(pictures.image(), place);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace seqloop::program
