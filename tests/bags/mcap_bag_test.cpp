// SPDX-License-Identifier: MIT
#include "bags/mcap_bag.hpp"

#include <algorithm>

#include "bags/bag_bytes.hpp"
#include "bags/packed.hpp"
#include "expect_setup_error.hpp"
#include "gtest/gtest.h"

namespace seqloop::bags {
namespace {

using test::McapBytes;

const std::string image = "sensor_msgs/msg/Image";

test::ByteVector data(int number) { return {static_cast<std::uint8_t>(number), 42}; }

/// Messages `first` to `first + 4` on channel 1, and one more each on channel 2.
McapBytes records(int first, bool definitions = true) {
  McapBytes made;
  if (definitions) made.schema(7, image).schema(8, "std_msgs/msg/String");
  if (definitions) made.channel(1, 7, "/camera").channel(2, 8, "/talk");
  for (int number = first; number < first + 5; ++number) {
    const auto time = static_cast<std::uint64_t>(1000 + number);
    made.message(1, time, data(number)).message(2, time, data(100 + number));
  }
  return made;
}

McapBytes chunked(const std::string& compression, int chunks = 3) {
  McapBytes file;
  file.start();
  for (int i = 0; i < chunks; ++i) {
    const McapBytes inside = records(5 * i);
    file.chunk(inside, compression, test::packed(compression, inside.bytes));
  }
  return file;
}

std::unique_ptr<Bag> opened(const McapBytes& file) {
  return open_mcap(std::make_unique<test::MemoryBytes>(file.bytes), "b.mcap");
}

/// @return first bytes of the messages; -1 for what is damaged
std::vector<int> read_all(Bag& bag, const std::string& topic) {
  std::vector<int> numbers;
  bag.choose(topic);
  Message message;
  for (Read read = bag.next(message); read != Read::end; read = bag.next(message))
    numbers.push_back(read == Read::damaged ? -1 : message.bytes[0]);
  return numbers;
}

std::vector<int> counted(int end) {
  std::vector<int> numbers;
  for (int i = 0; i < end; ++i) numbers.push_back(i);
  return numbers;
}

class McapCompression : public testing::TestWithParam<std::string> {};

const std::string read_twice =
    "the file has no full summary: all of it was read to find its topics";

TEST_P(McapCompression, WithoutASummaryEverythingIsFound) {
  const auto bag = opened(chunked(GetParam()).finish());
  const BagFacts& facts = bag->facts();
  ASSERT_EQ(facts.topics.size(), 2U);
  EXPECT_EQ(facts.topics[0].name, "/camera");
  EXPECT_EQ(facts.topics[0].type, image);
  EXPECT_EQ(facts.topics[0].encoding, "cdr");
  EXPECT_EQ(facts.topics[0].messages, 15U);
  EXPECT_EQ(facts.start_ns, 1000);
  EXPECT_EQ(facts.end_ns, 1014);
  EXPECT_EQ(read_all(*bag, "/camera"), counted(15));
  EXPECT_EQ(read_all(*bag, "/camera"), counted(15)) << "a second time";
  EXPECT_EQ(read_all(*bag, "/talk").front(), 100);
  EXPECT_TRUE(read_all(*bag, "/gone").empty());
  EXPECT_EQ(bag->notes(), std::vector<std::string>{read_twice});
}

TEST_P(McapCompression, CutOffAnywhereTheMessagesBeforeAreRead) {
  const auto whole = chunked(GetParam()).finish().bytes;
  std::size_t most = 0;
  for (std::size_t size = 8; size < whole.size(); size += 7) {
    McapBytes cut;
    cut.bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto bag = opened(cut);
    const auto numbers = read_all(*bag, "/camera");
    EXPECT_EQ(numbers, counted(static_cast<int>(numbers.size()))) << size;
    EXPECT_GE(numbers.size(), most) << size;
    most = numbers.size();
  }
  EXPECT_EQ(most, 15U);
}

TEST_P(McapCompression, ADamagedChunkIsOneDamage) {
  auto file = chunked(GetParam(), 1);
  const std::size_t start = file.bytes.size();
  const McapBytes inside = records(5);
  file.chunk(inside, GetParam(), test::packed(GetParam(), inside.bytes));
  const std::size_t end = file.bytes.size();
  const McapBytes last = records(10);
  file.chunk(last, GetParam(), test::packed(GetParam(), last.bytes)).finish();
  file.bytes[(start + 2 * end) / 3] ^= 0x55U;
  const auto bag = opened(file);
  auto numbers = read_all(*bag, "/camera");
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), -1), 1);
  std::erase(numbers, -1);
  EXPECT_TRUE(std::ranges::is_sorted(numbers));
  EXPECT_EQ(numbers.front(), 0);
  EXPECT_EQ(numbers.back(), 14);
  EXPECT_GE(numbers.size(), 10U);
}

INSTANTIATE_TEST_SUITE_P(Chunks, McapCompression, testing::ValuesIn(test::compressions()),
                         [](const auto& made) { return made.param.empty() ? "none" : made.param; });

TEST(McapBag, WithASummaryChunksOfOtherTopicsAreNotRead) {
  McapBytes file;
  file.start();
  McapBytes summary;
  summary.schema(7, image).schema(8, "std_msgs/msg/String");
  summary.channel(1, 7, "/camera").channel(2, 8, "/talk");
  for (int i = 0; i < 20; ++i) {
    const auto channel = static_cast<std::uint16_t>(i == 12 ? 1 : 2);
    const std::uint64_t place = file.bytes.size();
    McapBytes inside;
    inside.message(channel, 5, data(i));
    file.chunk(inside);
    McapBytes index;
    index.put(std::uint64_t{5}).put(std::uint64_t{5}).put(place).put(std::uint64_t{0});
    index.put(std::uint32_t{10}).put(channel).put(std::uint64_t{0}).put(std::uint64_t{0});
    index.text("").put(std::uint64_t{0}).put(std::uint64_t{0});
    summary.record(8, index);
  }
  McapBytes statistics;
  statistics.put(std::uint64_t{20}).put(std::uint16_t{2}).put(std::uint32_t{2});
  statistics.put(std::uint32_t{0}).put(std::uint32_t{0}).put(std::uint32_t{20});
  statistics.put(std::uint64_t{5}).put(std::uint64_t{5}).put(std::uint32_t{20});
  statistics.put(std::uint16_t{1})
      .put(std::uint64_t{1})
      .put(std::uint16_t{2})
      .put(std::uint64_t{19});
  summary.record(11, statistics);
  file.finish(summary);

  auto bytes = std::make_unique<test::MemoryBytes>(file.bytes);
  const test::MemoryBytes& watched = *bytes;
  const auto bag = open_mcap(std::move(bytes), "b.mcap");
  EXPECT_EQ(bag->facts().topics.at(1).messages, 19U);
  EXPECT_TRUE(bag->notes().empty());
  const std::size_t before = watched.reads;
  EXPECT_EQ(read_all(*bag, "/camera"), std::vector<int>{12});
  // The header's record, twenty heads, one chunk, the end of the data.
  EXPECT_EQ(watched.reads - before, 1U + 20U + 1U + 1U);

  file.bytes[file.bytes.size() - 12] ^= 1U;
  const auto damaged = opened(file);
  EXPECT_EQ(damaged->notes().at(0), "the check sum of the summary is wrong: it is not used");
}

/// @param counts of channels' messages, from 1 on
McapBytes with_statistics(McapBytes summary, std::initializer_list<std::uint64_t> counts) {
  McapBytes statistics;
  statistics.put(std::uint64_t{10}).put(std::uint16_t{2}).put(std::uint32_t{2});
  statistics.put(std::uint32_t{0}).put(std::uint32_t{0}).put(std::uint32_t{0});
  statistics.put(std::uint64_t{1000}).put(std::uint64_t{1004});
  statistics.put(static_cast<std::uint32_t>(10 * counts.size()));
  std::uint16_t channel = 0;
  for (const std::uint64_t count : counts) statistics.put(++channel).put(count);
  return summary.record(11, statistics);
}

TEST(McapBag, WhatASummaryLeavesOutIsFound) {
  const auto bag_with = [](const McapBytes& summary) {
    return opened(McapBytes().start().raw(records(0).bytes).finish(summary));
  };
  const McapBytes schemas = McapBytes().schema(7, image).schema(8, "std_msgs/msg/String");
  const McapBytes channels = McapBytes().channel(1, 7, "/camera").channel(2, 8, "/talk");
  const McapBytes both = McapBytes(schemas).raw(channels.bytes);
  EXPECT_TRUE(bag_with(with_statistics(both, {5, 5}))->notes().empty());
  for (const auto& [what, summary] : std::initializer_list<std::pair<const char*, McapBytes>>{
           {"schemas", with_statistics(channels, {5, 5})},
           {"one schema", with_statistics(McapBytes().schema(8, "").raw(channels.bytes), {5, 5})},
           {"counts", with_statistics(both, {})},
           {"one count", with_statistics(both, {5})},
           {"channels", with_statistics(schemas, {5, 5})},
           {"a channel", with_statistics(McapBytes(schemas).channel(2, 8, "/talk"), {5, 5})}}) {
    SCOPED_TRACE(what);
    const auto bag = bag_with(summary);
    ASSERT_EQ(bag->facts().topics.size(), 2U);
    EXPECT_EQ(bag->facts().topics[0].name, "/camera");
    EXPECT_EQ(bag->facts().topics[0].type, image);
    EXPECT_EQ(bag->facts().topics[0].messages, 5U);
    EXPECT_EQ(bag->facts().topics[1].messages, 5U);
    EXPECT_EQ(read_all(*bag, "/camera"), counted(5));
    EXPECT_EQ(bag->notes(), std::vector<std::string>{read_twice});
  }
}

TEST(McapBag, MessagesOutsideOfChunks) {
  McapBytes file;
  file.start().raw(records(0).bytes).finish();
  EXPECT_EQ(read_all(*opened(file), "/camera"), counted(5));
}

TEST(McapBag, TwoChannelsOfOneTopic) {
  McapBytes file;
  file.start().schema(7, image).channel(1, 7, "/camera").channel(2, 7, "/camera");
  file.message(1, 1, data(0)).message(2, 2, data(1)).message(1, 3, data(2)).finish();
  const auto bag = opened(file);
  ASSERT_EQ(bag->facts().topics.size(), 1U);
  EXPECT_EQ(bag->facts().topics[0].messages, 3U);
  EXPECT_EQ(read_all(*bag, "/camera"), counted(3));
}

TEST(McapBag, AChunkThatSaysItIsHugeTakesNoMemory) {
  McapBytes file;
  file.start();
  for (const std::uint64_t size : {std::uint64_t{1} << 29U, std::uint64_t{1} << 62U}) {
    const auto packed = test::packed(test::compressions().back(), records(0).bytes);
    file.record(6, McapBytes()
                       .put(std::uint64_t{0})
                       .put(std::uint64_t{0})
                       .put(size)
                       .put(std::uint32_t{0})
                       .text(test::compressions().back())
                       .put(std::uint64_t{packed.size()})
                       .raw(packed));
  }
  const auto bag = opened(file.finish());
  EXPECT_LE(read_all(*bag, "/camera").size(), 7U);
}

TEST(McapBag, WhatIsNoneIsRefused) {
  McapBytes file;
  file.text("PNG, perhaps");
  EXPECT_TRUE(test::says(test::setup_error([&] { static_cast<void>(opened(file)); }),
                         "b.mcap: is not an MCAP file"));
  EXPECT_TRUE(test::says(test::setup_error([&] { static_cast<void>(opened({})); }),
                         "b.mcap: is not an MCAP file"));
}

TEST(McapBag, AnotherPackingIsTold) {
  McapBytes file;
  file.start();
  file.chunk(records(0), "br", records(0).bytes).chunk(records(5)).finish();
  const auto bag = opened(file);
  bag->choose("/camera");
  Message message;
  EXPECT_EQ(bag->next(message), Read::damaged);
  EXPECT_EQ(message.fault, "a chunk is packed in a way that is not known");
  EXPECT_EQ(bag->next(message), Read::message);
}

TEST(Checksum, OfKnownBytes) {
  const std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(mcap::checksum(digits), 0xcbf43926U);
  EXPECT_EQ(
      mcap::checksum(std::span(digits).subspan(4), mcap::checksum(std::span(digits).first(4))),
      0xcbf43926U);
}

}  // namespace
}  // namespace seqloop::bags
