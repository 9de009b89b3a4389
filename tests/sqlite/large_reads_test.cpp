// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

#include "seqloop/sqlite/map_file.hpp"
#include "sqlite/sample_map.hpp"
#include "temporary_folder.hpp"

namespace seqloop {
namespace {

using sqlite::MapFile;

/// What the process has asked the system to read.
struct Asked {
  std::uint64_t bytes = 0;
  std::uint64_t times = 0;
};

/// None where the system does not count.
std::optional<Asked> asked() {
  std::ifstream io("/proc/self/io");
  Asked sum;
  std::string key;
  for (std::uint64_t value = 0; io >> key >> value;) {
    if (key == "rchar:") sum.bytes = value;
    if (key == "syscr:") sum.times = value;
  }
  if (sum.times == 0) return std::nullopt;
  return sum;
}

class LargeReads : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "map.seqloop"; }

  [[nodiscard]] MapFile make(std::uint64_t place_bytes) const {
    sqlite::MapForm form = test::sample_form();
    form.place_bytes = place_bytes;
    return MapFile::open(file(), form);
  }

  /// Reads all of a map, each place of which must be as it was saved.
  /// @param begun called with the first block @return places
  static std::size_t places(const MapFile& map, const std::function<void()>& begun = {}) {
    std::size_t count = 0;
    const auto bytes = static_cast<std::size_t>(map.form().place_bytes);
    map.read([&](const sqlite::PlaceBlock& block) {
      if (count == 0 && begun) begun();
      count += block.records.size();
      for (std::size_t i = 0; i < block.records.size(); ++i) {
        EXPECT_TRUE(std::ranges::equal(block.places.subspan(i * bytes, bytes),
                                       test::sample_place(block.records[i].number, bytes)));
      }
    });
    return count;
  }

  test::TemporaryFolder folder_;
};

TEST_F(LargeReads, TakeManyPagesAtOnce) {
  {
    MapFile map = make(40'000);
    const std::int64_t id = map.begin_session("a", 0, "");
    for (std::uint64_t batch = 0; batch < 15; ++batch) test::save_sample(map, id, batch * 9, 9);
    EXPECT_EQ(places(map), 135U) << "most of it in the log";
  }
  const MapFile map = MapFile::read_only(file());
  const auto before = asked();
  EXPECT_EQ(places(map), 135U);
  const auto after = asked();
  if (!before || !after) GTEST_SKIP() << "this system does not count reads";
  const std::uint64_t pages = std::filesystem::file_size(file()) / 8192;
  EXPECT_LT((after->times - before->times) * 5, pages);
  EXPECT_LT(after->bytes - before->bytes, pages * 8192 * 5 / 4);
}

TEST_F(LargeReads, OfPagesThatLieApartAreNone) {
  {
    // Blocks of a session come back to back, and lie between those of 20 others.
    MapFile map = make(4000);
    constexpr std::uint64_t sessions = 21;
    for (std::uint64_t i = 0; i < sessions; ++i) {
      (void)map.begin_session(std::to_string(i), 0, "");
    }
    for (std::uint64_t batch = 0; batch < 10; ++batch) {
      for (std::uint64_t i = 0; i < sessions; ++i) {
        test::save_sample(map, static_cast<std::int64_t>(i + 1), batch * 9, 9, {},
                          i * 1000 + batch * 9);
      }
    }
  }
  const MapFile map = MapFile::read_only(file());
  const auto before = asked();
  EXPECT_EQ(places(map), 1890U);
  const auto after = asked();
  if (!before || !after) GTEST_SKIP() << "this system does not count reads";
  EXPECT_LT(after->bytes - before->bytes, std::filesystem::file_size(file()) * 3 / 2);
}

TEST_F(LargeReads, AreOfOneMoment) {
  MapFile map = make(40'000);
  const std::int64_t id = map.begin_session("a", 0, "");
  for (std::uint64_t batch = 0; batch < 15; ++batch) test::save_sample(map, id, batch * 9, 9);
  const MapFile reader = MapFile::read_only(file());
  // Ten megabytes go by, so that the log goes into the file, while it is being read.
  const auto write = [&] {
    for (std::uint64_t batch = 0; batch < 30; ++batch) {
      test::save_sample(map, id, 135 + batch * 9, 9, {batch * 4, batch * 4 + 1, batch * 4 + 2});
    }
  };
  EXPECT_EQ(places(reader, write), 135U);
  EXPECT_EQ(places(reader), 135U);
  EXPECT_EQ(places(map), 135U + 270U - 90U);
}

}  // namespace
}  // namespace seqloop
