// SPDX-License-Identifier: MIT
// Messages and bags damaged at random: always an answer or a SetupError, never a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <random>

#include "bags/bag_bytes.hpp"
#include "bags/db3_bag.hpp"
#include "bags/mcap_bag.hpp"
#include "bags/packed.hpp"
#include "guarded_bytes.hpp"
#include "ros/pictures.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/ros/odometry.hpp"
#include "temporary_folder.hpp"
#if SEQLOOP_SQLITE
#include "bags/db3_file.hpp"
#endif

namespace seqloop {
namespace {

constexpr int inputs = 20'000;

/// One to eight bytes changed, a span removed or doubled, or the end cut off.
test::ByteVector damaged(test::ByteVector bytes, std::mt19937& random) {
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (std::size_t times = 1 + below(8); times > 0 && !bytes.empty(); --times) {
    const std::size_t at = below(bytes.size());
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto span =
        static_cast<std::ptrdiff_t>(1 + below(std::min<std::size_t>(40, bytes.size() - at)));
    switch (below(8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(place, place + span);
        break;
      case 2: {
        const test::ByteVector doubled(place, place + span);
        bytes.insert(place, doubled.begin(), doubled.end());
        break;
      }
      case 3:
        bytes[at] = below(2) == 0 ? 0 : 0xff;
        break;
      default:
        bytes[at] = static_cast<std::uint8_t>(below(256));
    }
  }
  return bytes;
}

/// @param read whether it was taken, of bytes behind which there is no memory
void fuzz(const std::vector<test::ByteVector>& good, std::uint32_t seed,
          const std::function<bool(std::span<const std::uint8_t>)>& read) {
  std::mt19937 random(seed);
  test::GuardedBytes memory(1 << 20);
  std::size_t taken = 0;
  std::size_t refused = 0;
  for (int i = 0; i < inputs; ++i) {
    const auto bytes = damaged(good[static_cast<std::size_t>(i) % good.size()], random);
    bool whole = false;
    try {
      whole = read(memory.hold(bytes));
    } catch (const SetupError& error) {
      ASSERT_FALSE(error.faults().empty());
    }
    ++(whole ? taken : refused);
  }
  std::printf("seed %u: %zu taken, %zu refused\n", seed, taken, refused);
  EXPECT_GT(taken, 100U);
  EXPECT_GT(refused, 100U);
}

/// Looks at every byte that is handed over. @return whether nothing was damaged
bool read_all(bags::Bag& bag) {
  bool whole = true;
  for (const bags::Topic& topic : bag.facts().topics) {
    bag.choose(topic.name);
    bags::Message message;
    for (bags::Read read = bag.next(message); read != bags::Read::end; read = bag.next(message)) {
      volatile std::uint8_t byte = 0;
      for (const std::uint8_t one : message.bytes) byte = one;
      static_cast<void>(byte);
      whole = whole && read == bags::Read::message;
    }
  }
  return whole && bag.notes().empty() && !bag.facts().topics.empty();
}

test::McapBytes records() {
  test::McapBytes made;
  made.schema(1, "sensor_msgs/msg/Image").channel(1, 1, "/camera").channel(2, 1, "/rear");
  for (std::uint16_t i = 0; i < 20; ++i)
    made.message(static_cast<std::uint16_t>(1 + i % 2), i,
                 test::ByteVector(50, static_cast<std::uint8_t>(i)));
  return made;
}

TEST(BagFuzz, Cdr) {
  const test::ByteVector pixels(12, 7);
  fuzz({test::image_message(1'000'000'001, 3, 4, "mono8", 3, pixels),
        test::image_message(1'000'000'001, 3, 4, "mono8", 3, pixels, false),
        test::compressed_message(1'000'000'001, "jpeg", std::array<std::uint8_t, 3>{255, 216, 255}),
        test::odometry_message(1'000'000'001)},
       1, [](std::span<const std::uint8_t> bytes) {
         FixedText fault;
         static_cast<void>(ros::read_picture(ros::PictureType::compressed, bytes, fault));
         const auto read = ros::read_picture(ros::PictureType::image, bytes, fault);
         volatile std::uint8_t byte = 0;
         for (const std::uint8_t one : read.picture.bytes) byte = one;
         static_cast<void>(byte);
         const bool pose = ros::read_odometry(bytes).has_value();
         return fault.empty() || pose;
       });
}

TEST(BagFuzz, Mcap) {
  std::vector<test::ByteVector> good;
  for (const std::string& compression : test::compressions()) {
    test::McapBytes file;
    file.start();
    file.chunk(records(), compression, test::packed(compression, records().bytes));
    file.raw(records().bytes);
    test::McapBytes summary = records();
    test::McapBytes statistics;
    statistics.raw(test::ByteVector(8 + 2 + 4 * 4 + 16)).put(std::uint32_t{10});
    statistics.put(std::uint16_t{1}).put(std::uint64_t{10});
    summary.record(11, statistics);
    good.push_back(file.finish(summary).bytes);
  }
  fuzz(good, 2, [](std::span<const std::uint8_t> bytes) {
    const auto bag = bags::open_mcap(
        std::make_unique<test::MemoryBytes>(test::ByteVector(bytes.begin(), bytes.end())), "fuzz");
    return read_all(*bag);
  });
}

#if SEQLOOP_SQLITE
TEST(BagFuzz, Db3) {
  const test::TemporaryFolder folder;
  std::vector<test::ByteVector> good;
  for (const int version : {1, 4}) {
    const auto file = folder.path() / (std::to_string(version) + ".db3");
    std::vector<test::Db3Message> messages;
    for (int i = 0; i < 8; ++i)
      messages.push_back({1 + i % 2, i, test::ByteVector(i == 5 ? 9'000 : 50, 7)});
    test::write_db3(file, version, {{"/camera", "sensor_msgs/msg/Image"}, {"/rear", "x"}},
                    messages);
    const std::string text = test::read_all(file);
    good.emplace_back(text.begin(), text.end());
  }
  fuzz(good, 3, [](std::span<const std::uint8_t> bytes) {
    const auto bag = bags::open_db3(bytes);
    return read_all(*bag);
  });
}
#endif

}  // namespace
}  // namespace seqloop
