// SPDX-License-Identifier: MIT
#include "bags/db3_bag.hpp"

#include "expect_setup_error.hpp"
#include "gtest/gtest.h"
#include "temporary_folder.hpp"

#if SEQLOOP_SQLITE
#include "bags/db3_file.hpp"
#include "pages_in_circles.hpp"

namespace seqloop::bags {
namespace {

std::vector<int> read_all(Bag& bag, const std::string& topic) {
  std::vector<int> numbers;
  bag.choose(topic);
  Message message;
  for (Read read = bag.next(message); read != Read::end; read = bag.next(message))
    numbers.push_back(read == Read::damaged ? -1 : message.bytes[0]);
  return numbers;
}

class Db3Schema : public testing::TestWithParam<int> {};

TEST_P(Db3Schema, TopicsAndMessages) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a bag?.db3";
  test::write_db3(file, GetParam(),
                  {{"/talk", "std_msgs/msg/String"}, {"/camera", "sensor_msgs/msg/Image"}},
                  {{1, 100, {9}}, {2, 101, {0}}, {2, 102, {1}}, {1, 103, {9}}, {2, 104, {2}}});
  const auto bag = open_bag(file);
  const BagFacts& facts = bag->facts();
  EXPECT_EQ(facts.format,
            GetParam() < 3 ? "rosbag2 db3" : "rosbag2 db3, schema " + std::to_string(GetParam()));
  ASSERT_EQ(facts.topics.size(), 2U);
  EXPECT_EQ(facts.topics[0].name, "/camera");
  EXPECT_EQ(facts.topics[0].type, "sensor_msgs/msg/Image");
  EXPECT_EQ(facts.topics[0].encoding, "cdr");
  EXPECT_EQ(facts.topics[0].messages, 3U);
  EXPECT_EQ(facts.start_ns, 100);
  EXPECT_EQ(facts.end_ns, 104);
  EXPECT_EQ(read_all(*bag, "/camera"), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(read_all(*bag, "/camera"), (std::vector<int>{0, 1, 2})) << "a second time";
  EXPECT_EQ(read_all(*bag, "/talk"), (std::vector<int>{9, 9}));
  EXPECT_TRUE(read_all(*bag, "/gone").empty());
  // Nothing was made beside it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

INSTANTIATE_TEST_SUITE_P(Versions, Db3Schema, testing::Values(1, 2, 3, 4));

TEST(Db3Bag, WhatIsNoneIsRefused) {
  const test::TemporaryFolder folder;
  const auto says = [](const std::filesystem::path& file, const std::string& part) {
    return test::says(test::setup_error([&] { static_cast<void>(open_bag(file)); }), part);
  };
  EXPECT_TRUE(says(folder.path() / "gone.db3", "does not exist"));
  EXPECT_TRUE(
      says(folder.write("text.db3", "no database at all, but text"), "is not a bag of rosbag2"));
  EXPECT_TRUE(says(folder.write("empty.db3", ""), "it has no tables of topics and messages"));
  test::run_sql(folder.path() / "other.db3",
                "CREATE TABLE topics(a); CREATE VIEW messages AS SELECT 1");
  EXPECT_TRUE(says(folder.path() / "other.db3", "it has no tables of topics and messages"));
}

TEST(Db3Bag, AFileThatIsStillWrittenIsNotTouched) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "b.db3";
  test::write_db3(file, 4, {}, {});
  folder.write("b.db3-wal", "something");
  const std::string message = test::setup_error([&] { static_cast<void>(open_bag(file)); });
  EXPECT_TRUE(test::says(message, "its writer has not closed it: there is also"));
  EXPECT_EQ(test::read_all(folder.path() / "b.db3-wal"), "something");
}

TEST(Db3Bag, AFileOfAFolderThatIsNoneSaysWhyInItsTurn) {
  const test::TemporaryFolder folder;
  test::write_db3(folder.path() / "b_0.db3", 4, {{"/camera", "sensor_msgs/msg/Image"}},
                  {{1, 100, {0}}});
  test::run_sql(folder.path() / "b_1.db3",
                "CREATE TABLE topics(id, name, type); CREATE TABLE messages(topic_id, timestamp)");
  const auto bag = open_bag(folder.path());
  bag->choose("/camera");
  Message message;
  EXPECT_EQ(bag->next(message), Read::message);
  EXPECT_EQ(bag->next(message), Read::damaged);
  EXPECT_TRUE(test::says(std::string(message.fault), "b_1.db3: is not a bag of rosbag2"));
  EXPECT_TRUE(test::says(std::string(message.fault), "no such column: m.data"));
  EXPECT_EQ(bag->next(message), Read::end);
}

TEST(Db3Bag, PagesInCirclesAreDamage) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "b.db3";
  test::write_db3(file, 1, {{"/camera", "sensor_msgs/msg/Image"}},
                  std::vector<test::Db3Message>(10, {1, 7, {9}}));
  test::lead_in_circles(file, "messages");
  EXPECT_TRUE(test::says(test::setup_error([&] { static_cast<void>(open_bag(file)); }),
                         "b.db3: is damaged: it has more rows than there is room for in it"));
}

TEST(Db3Bag, CutOffEndsWithADamage) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "b.db3";
  std::vector<test::Db3Message> messages;
  for (int i = 0; i < 50; ++i)
    messages.push_back({1, i, std::vector<std::uint8_t>(20'000, static_cast<std::uint8_t>(i))});
  test::write_db3(file, 4, {{"/camera", "sensor_msgs/msg/Image"}}, messages);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  try {
    const auto bag = open_bag(file);
    auto numbers = read_all(*bag, "/camera");
    EXPECT_EQ(numbers.back(), -1);
    EXPECT_FALSE(bag->notes().empty());
  } catch (const SetupError& error) {  // the tables' own pages are gone
    EXPECT_TRUE(test::says(error.what(), "is not a bag of rosbag2"));
  }
}

}  // namespace
}  // namespace seqloop::bags
#else
TEST(Db3Bag, ABuildWithoutSqliteSaysSo) {
  const seqloop::test::TemporaryFolder folder;
  const auto file = folder.write("b.db3", "");
  EXPECT_TRUE(seqloop::test::says(
      seqloop::test::setup_error([&] { static_cast<void>(seqloop::bags::open_bag(file)); }),
      "this build has no libsqlite3"));
}
#endif
