// SPDX-License-Identifier: MIT
#include "seqloop/sqlite/map_file.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "expect_setup_error.hpp"
#include "seqloop/sqlite/recover.hpp"
#include "sqlite/checksum.hpp"
#include "sqlite/pages_ahead.hpp"
#include "sqlite/recording_vfs.hpp"
#include "sqlite/sample_map.hpp"
#include "temporary_folder.hpp"

namespace seqloop {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;
using test::says;
using test::setup_error;
using What = test::FileEvent::What;

constexpr std::size_t wide = std::size_t{1} << 16U;  // bytes of a large place

class Map : public testing::Test {
 protected:
  [[nodiscard]] fs::path file(const std::string& name = "map.seqloop") const {
    return folder_.path() / name;
  }
  [[nodiscard]] MapFile open() const { return MapFile::open(file(), test::sample_form()); }

  /// Two sessions with 40 places each, in four batches.
  void make(const std::string& name = "map.seqloop") const {
    MapFile map = MapFile::open(file(name), test::sample_form());
    for (const char* session : {"monday", "tuesday"}) {
      const std::int64_t id = map.begin_session(session, 1'700'000'000'000'000'000, "k = 10\n");
      for (std::uint64_t i = 0; i < 4; ++i) test::save_sample(map, id, i * 11, 10);
    }
  }

  /// What a map holds; a failed test where something is wrong with it.
  static std::string content(const MapFile& map) {
    std::string fault;
    std::string text = test::content_of(map, fault);
    EXPECT_EQ(fault, "");
    return text;
  }
  [[nodiscard]] std::string content() const { return content(MapFile::read_only(file())); }

  static std::set<std::uint64_t> numbers(const MapFile& map) {
    std::set<std::uint64_t> found;
    map.read([&found](const sqlite::PlaceBlock& block) {
      for (std::size_t i = 0; i < block.records.size(); ++i) {
        found.insert(block.records[i].number);
        EXPECT_TRUE(std::ranges::equal(block.places.subspan(i * 200, 200),
                                       test::sample_place(block.records[i].number)));
      }
    });
    return found;
  }

  test::TemporaryFolder folder_;
};

TEST(RowChecksum, IsZlibs) {
  const std::string digits = "123456789";
  EXPECT_EQ(sqlite::crc32(std::as_bytes(std::span(digits))), 0xCBF43926U);
  for (const std::size_t size : {0U, 1U, 15U, 16U, 17U, 63U, 64U, 65U, 127U, 128U, 200U, 1000U}) {
    const std::vector<std::byte> bytes = test::sample_place(7, size);
    std::uint32_t naive = 0xFFFFFFFFU;
    for (const std::byte byte : bytes) {
      naive ^= std::to_integer<std::uint32_t>(byte);
      for (int bit = 0; bit < 8; ++bit) {
        naive = (naive >> 1U) ^ ((naive & 1U) != 0 ? 0xEDB88320U : 0U);
      }
    }
    EXPECT_EQ(sqlite::crc32(bytes), ~naive) << size;
  }
}

TEST_F(Map, IsReadAsItWasSaved) {
  std::string saved;
  {
    make();
    MapFile map = open();
    saved = content(map);
    EXPECT_EQ(map.next_place(), 80U);
    EXPECT_EQ(map.sessions().size(), 2U);
    EXPECT_EQ(map.sessions()[1].name, "tuesday");
    EXPECT_EQ(map.sessions()[1].frames, 44U);
    EXPECT_EQ(map.sessions()[1].places, 40U);
    EXPECT_EQ(map.thumbnail(40)->jpeg, test::sample_place(40, 700));
    EXPECT_FALSE(map.thumbnail(41));
    EXPECT_EQ(map.thumbnail_facts().count, 8U);
    EXPECT_EQ(map.thumbnail_facts().bytes, 8U * 700U);
    using Numbers = std::vector<std::uint64_t>;
    EXPECT_EQ(map.thumbnails_around(0), (Numbers{0, 10}));
    EXPECT_EQ(map.thumbnails_around(40), (Numbers{30, 40, 50}));
    EXPECT_EQ(map.thumbnails_around(44), (Numbers{30, 40, 50}));
    EXPECT_EQ(map.thumbnails_around(46), (Numbers{40, 50, 60}));
    EXPECT_EQ(map.thumbnails_around(65), (Numbers{50, 60, 70})) << "of two as near, the earlier";
    EXPECT_EQ(map.thumbnails_around(999), (Numbers{60, 70}));
    EXPECT_EQ(numbers(map).size(), 80U);
  }
  EXPECT_EQ(content(), saved);
  EXPECT_EQ(content(open()), saved);
}

/// Two sessions that grow by turns, so that their rows are not in the order of the file's pages;
/// 26 MB: enough to be read ahead.
void make_large(MapFile& map) {
  constexpr std::size_t batch = 7;
  std::array<std::int64_t, 2> sessions{map.begin_session("monday", 1, ""),
                                       map.begin_session("tuesday", 2, "")};
  for (std::uint64_t first = 0; first < 28 * batch; first += batch) {
    for (const std::int64_t session : sessions) {
      std::vector<sqlite::PlaceRecord> records;
      std::vector<std::byte> places;
      for (std::uint64_t i = first; i < first + batch; ++i) {
        records.push_back({(static_cast<std::uint64_t>(session) << 32U) + i, i, 0});
        const std::vector<std::byte> place = test::sample_place(records.back().number, wide);
        places.insert(places.end(), place.begin(), place.end());
      }
      map.save(session, {.frames = first + batch, .records = records, .places = places});
    }
  }
}

/// @return how many places are as they were saved
std::size_t right_places(const MapFile& map, std::vector<std::string>& damaged) {
  std::size_t right = 0;
  map.read(
      [&right](const sqlite::PlaceBlock& block) {
        for (std::size_t i = 0; i < block.records.size(); ++i) {
          const auto place = block.places.subspan(i * wide, wide);
          if (std::ranges::equal(place, test::sample_place(block.records[i].number, wide))) ++right;
        }
      },
      [&damaged](const std::string& what) { damaged.push_back(what); });
  return right;
}

/// Has the system forget what it keeps of a file. No connection of this process may be open.
void drop(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(::fdatasync(descriptor), 0);
  EXPECT_EQ(::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED), 0);
  ::close(descriptor);
}

TEST_F(Map, ThatIsLargeIsReadAheadAndTheSame) {
  constexpr std::size_t all = 2 * 28 * 7;
  const sqlite::MapForm form{"wide", "test", wide, wide};
  std::vector<std::string> damaged;
  {
    MapFile map = MapFile::open(file(), form);
    make_large(map);
    EXPECT_EQ(right_places(map, damaged), all);
    EXPECT_EQ(right_places(MapFile::read_only(file()), damaged), all) << "a part is in the log";
  }
  for (const bool cached : {true, false}) {
    if (!cached) drop(file());
    EXPECT_EQ(right_places(MapFile::read_only(file()), damaged), all) << cached;
    if (!cached) drop(file());
    const sqlite::Database database(file(), SQLITE_OPEN_READONLY);
    const sqlite::PagesAhead pages(database, file());
    sqlite::Statement row(database, "SELECT places FROM block ORDER BY first");
    while (row.step()) EXPECT_EQ(row.blob(0).size() % wide, 0U);
    // Not every file system can be read past the cache.
    if (sqlite::UncachedFile(file()).bytes() != 0) {
      EXPECT_GT(pages.given(), fs::file_size(file()) / 2) << cached;
    }
  }
  EXPECT_TRUE(damaged.empty());
  {
    std::fstream bytes(file(), std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(static_cast<std::streamoff>(fs::file_size(file()) / 2 + 100));
    bytes.write("damaged", 7);
  }
  EXPECT_EQ(right_places(MapFile::read_only(file()), damaged), all - 7);
  ASSERT_EQ(damaged.size(), 1U);
  EXPECT_TRUE(damaged.front().starts_with("the block from place ")) << damaged.front();
  fs::resize_file(file(), fs::file_size(file()) / 2);
  EXPECT_THROW(right_places(MapFile::read_only(file()), damaged), SetupError);
}

TEST_F(Map, ThatIsClosedIsOneFileWhoseKindIsSeen) {
  make();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
  const std::string bytes = test::read_all(file());
  EXPECT_EQ(bytes.substr(0, 15), "SQLite format 3");
  EXPECT_EQ(bytes.substr(68, 4), "SeqL");
  EXPECT_EQ(bytes.substr(60, 4), std::string("\0\0\0\1", 4));
  (void)content();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(Map, TakesPlacesOfAnySize) {
  for (const std::uint64_t size : {1U, 7U, 8'192U, 1'048'576U, 5'000'000U}) {
    sqlite::MapForm form = test::sample_form();
    form.place_bytes = size;
    const fs::path path = file(std::to_string(size));
    std::string saved;
    {
      MapFile map = MapFile::open(path, form);
      const std::int64_t id = map.begin_session("a", 0, "");
      test::save_sample(map, id, 0, 9);
      test::save_sample(map, id, 10, 0);
      saved = content(map);
    }
    EXPECT_EQ(content(MapFile::read_only(path)), saved);
  }
  for (const std::uint64_t size : {std::uint64_t{0}, (std::uint64_t{1} << 26U) + 1}) {
    sqlite::MapForm form = test::sample_form();
    form.place_bytes = size;
    const std::string fault = setup_error([&] { (void)MapFile::open(file("bad"), form); });
    EXPECT_TRUE(says(fault, "bytes"));
    EXPECT_FALSE(fs::exists(file("bad")));
  }
}

TEST_F(Map, ReadingThatIsGivenUpLeavesItAsItWas) {
  sqlite::MapForm form = test::sample_form();
  form.place_bytes = 100'000;
  MapFile map = MapFile::open(file(), form);
  const std::int64_t id = map.begin_session("a", 0, "");
  for (std::uint64_t batch = 0; batch < 10; ++batch) test::save_sample(map, id, batch * 9, 9);
  // Batches are read ahead: given up with none, some and all of them waiting.
  for (const std::size_t blocks : {0U, 1U, 4U, 9U}) {
    std::size_t taken = 0;
    const auto give_up = [&](const sqlite::PlaceBlock&) {
      if (taken++ == blocks) throw std::runtime_error("enough");
    };
    EXPECT_THROW(map.read(give_up), std::runtime_error);
    EXPECT_EQ(taken, blocks + 1);
  }
  std::uint64_t next = 0;
  const auto bytes = static_cast<std::size_t>(form.place_bytes);
  map.read([&](const sqlite::PlaceBlock& block) {
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      ASSERT_EQ(block.records[i].number, next);
      const auto place = block.places.subspan(i * bytes, bytes);
      ASSERT_TRUE(std::ranges::equal(place, test::sample_place(next, bytes)));
      ++next;
    }
  });
  EXPECT_EQ(next, 90U);
}

TEST_F(Map, RefusesBatchesThatDoNotFit) {
  MapFile map = open();
  const std::int64_t first = map.begin_session("a", 0, "");
  test::save_sample(map, first, 0, 5);
  const std::string before = content(map);
  const std::vector<std::byte> place = test::sample_place(0);
  for (const std::uint64_t number : {std::uint64_t{4}, std::uint64_t{1} << 62U}) {
    const std::array<sqlite::PlaceRecord, 1> record{{{number, 0, 0}}};
    EXPECT_THROW(map.save(first, {.records = record, .places = place}), std::invalid_argument);
  }
  const std::array<sqlite::PlaceRecord, 1> record{{{9, 5, 0}}};
  EXPECT_THROW(map.save(first, {.records = record}), std::invalid_argument);
  // The last frame is 4.
  for (const auto& [one, other] : {std::pair{4U, 5U}, {3U, 5U}, {7U, 7U}, {7U, 6U}}) {
    const std::array<sqlite::PlaceRecord, 2> records{{{5, one, 0}, {6, other, 0}}};
    const std::vector<std::byte> places(2 * place.size());
    EXPECT_THROW(map.save(first, {.records = records, .places = places}), std::invalid_argument)
        << one << ", " << other;
  }
  EXPECT_THROW(map.save(first + 1, {}), std::invalid_argument);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> five(5, 1.0);
  for (const auto& [mean, variance] :
       std::vector<std::pair<std::vector<double>, std::vector<double>>>{
           {{1, 2}, {1, 2}},
           {five, {1}},
           {five, {1, 1, 1, 1, -1}},
           {five, {1, 1, 1, 1, nan}},
           {{1, 1, 1, 1, nan}, five}}) {
    const sqlite::SavedStatistics statistics{1, mean, variance};
    EXPECT_THROW(map.save(first, {.frames = 6, .statistics = &statistics}), std::invalid_argument);
  }
  constexpr std::uint64_t none = sqlite::number_end;
  for (const sqlite::SavedLink& link : std::vector<sqlite::SavedLink>{
           {0, none, 1, 0, .9}, {0, 1, none, 0, .9}, {0, 1, 1, none, .9}, {0, 1, 1, 0, nan}}) {
    EXPECT_THROW(map.save(first, {.frames = 6, .links = std::span(&link, 1)}),
                 std::invalid_argument);
  }
  const std::array<sqlite::SavedThumbnail, 1> picture{{{none, place}}};
  EXPECT_THROW(map.save(first, {.frames = 6, .thumbnails = picture}), std::invalid_argument);
  EXPECT_THROW(map.save(first, {.frames = none}), std::invalid_argument);
  EXPECT_THROW((void)map.retire("a", 0, 4, {}, 0), std::invalid_argument);
  map.save(first, {});
  EXPECT_EQ(map.sessions()[0].frames, 6U) << "what is dealt with stays so";
  EXPECT_EQ(content(map), before);
  const std::string fault = setup_error([&] { (void)map.begin_session("a", 0, ""); });
  EXPECT_TRUE(says(fault, "there is a session 'a' already"));
}

TEST_F(Map, SeveralSessionsGrowSideBySide) {
  MapFile map = open();
  constexpr std::uint64_t room = 1000;
  std::array<std::int64_t, 3> ids{};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ids[i] = map.begin_session("robot " + std::to_string(i), 0, "");
  }
  // Not in the order in which they began.
  for (const std::uint64_t batch : {0U, 1U, 2U, 3U}) {
    for (const std::size_t robot : {2U, 0U, 1U}) {
      if (robot == 2 && batch == 3) continue;
      test::save_sample(map, ids[robot], batch * 11, 10, {}, robot * room + batch * 10);
    }
  }
  std::uint64_t last = 0;
  std::map<std::int64_t, std::size_t> places;
  map.read([&](const sqlite::PlaceBlock& block) {
    for (const sqlite::PlaceRecord& record : block.records) {
      EXPECT_GE(record.number, last);
      last = record.number;
      EXPECT_EQ(record.number / room, static_cast<std::uint64_t>(block.session - ids[0]));
      ++places[block.session];
    }
  });
  EXPECT_EQ(places,
            (std::map<std::int64_t, std::size_t>{{ids[0], 40}, {ids[1], 40}, {ids[2], 30}}));
  EXPECT_EQ(map.next_place(), 2 * room + 30);
  const std::string before = content(map);
  const auto refused = [&](std::int64_t session, std::uint64_t first, std::uint64_t end) {
    const std::array<sqlite::PlaceRecord, 2> records{{{first, 0, 0}, {end, 1, 0}}};
    const std::vector<std::byte> bytes(2 *
                                       static_cast<std::size_t>(test::sample_form().place_bytes));
    EXPECT_THROW(map.save(session, {.records = records, .places = bytes}), std::invalid_argument)
        << session << ": " << first << ", " << end;
  };
  refused(ids[0], 39, 50);                // its own
  refused(ids[0], 40, room);              // the next one's
  refused(ids[0], room + 40, room + 50);  // behind the next one's
  refused(ids[1], 50, 60);                // before its own
  refused(ids[1], 2 * room + 40, 2 * room + 50);
  refused(ids[2], 2 * room + 29, 2 * room + 40);
  refused(ids[2] + 1, 9 * room, 9 * room + 1);
  EXPECT_EQ(content(map), before);
}

TEST_F(Map, PlacesThatCannotFollowAreNamedAndRecoverLeavesOutAsFewAsItCan) {
  const auto recovered = [this](const std::string& out) {
    const sqlite::Recovered found = sqlite::recover(file(), file(out));
    EXPECT_EQ(MapFile::read_only(file(out)).check(), std::vector<std::string>{});
    return std::pair{found.places, found.lost};
  };
  using Words = std::vector<std::string>;
  make();
  test::set_frame(file(), 1, 99'999);
  EXPECT_EQ(MapFile::read_only(file()).check(),
            Words{"place 2 of session 'monday' cannot follow place 1: its frame is 2, and that "
                  "of place 1 is 99999"});
  EXPECT_EQ(recovered("one"), (std::pair{std::uint64_t{79}, Words{"session 'monday': 1 of 40 "
                                                                  "places"}}));
  EXPECT_EQ(MapFile::read_only(file("one")).sessions()[0].frames, 44U);
  EXPECT_FALSE(numbers(MapFile::read_only(file("one"))).contains(1));

  // Between blocks, and of the second session.
  test::set_frame(file(), 1, 1);
  test::set_frame(file(), 50, 9);
  EXPECT_EQ(MapFile::read_only(file()).check(),
            Words{"place 50 of session 'tuesday' cannot follow place 49: its frame is 9, and that "
                  "of place 49 is 9"});
  EXPECT_EQ(recovered("two").first, 79U);

  // The last place of a session may be of any frame: a camera counts those that were lost, too.
  test::set_frame(file(), 50, 11);
  test::set_frame(file(), 39, 99'999);
  EXPECT_EQ(MapFile::read_only(file()).check(), Words{});
  EXPECT_EQ(recovered("three").first, 80U);
}

TEST_F(Map, PlacesThatCannotFollowAreNotAdded) {
  make();
  test::set_frame(file(), 30, 3);
  MapFile map = MapFile::open(file("other"), test::sample_form());
  const std::string fault = setup_error([&] { (void)map.add(MapFile::read_only(file())); });
  EXPECT_TRUE(says(fault, "its places cannot follow each other; `seqloop map check` says more"));
  EXPECT_TRUE(map.sessions().empty());
}

TEST_F(Map, PlacesThatGoDoNotComeBackAndTheirNumbersAreNotUsedAgain) {
  std::mt19937_64 random(5);
  std::set<std::uint64_t> left;
  MapFile map = open();
  const std::int64_t id = map.begin_session("a", 0, "");
  for (std::uint64_t batch = 0; batch < 60; ++batch) {
    SCOPED_TRACE(batch);
    const std::uint64_t next = map.next_place();
    ASSERT_EQ(next, batch * 7);
    std::vector<std::uint64_t> removed;
    for (int i = 0; i < 6; ++i) removed.push_back(random() % (next + 8));
    for (std::uint64_t number = next; number < next + 7; ++number) left.insert(number);
    for (const std::uint64_t number : removed) left.erase(number);
    test::save_sample(map, id, batch * 8, 7, removed);
    ASSERT_EQ(numbers(map), left);
    ASSERT_EQ(map.sessions()[0].places, left.size());
  }
  map.compact();
  EXPECT_EQ(numbers(map), left);
  EXPECT_EQ(map.next_place(), 420U);
  (void)content(map);
  // Of what was removed nothing is left, in pages of 8 KB for nine tables.
  EXPECT_LT(fs::file_size(file()), left.size() * 230 + 60 * 800 + 10 * 8192);
  map.save(id, {.frames = 480, .removed = std::vector<std::uint64_t>(left.begin(), left.end())});
  EXPECT_EQ(numbers(map).size(), 0U);
  EXPECT_EQ(map.next_place(), 420U);
}

TEST_F(Map, ForgetsOneSessionAlone) {
  make();
  MapFile map = open();
  map.forget("monday");
  EXPECT_EQ(map.sessions().size(), 1U);
  EXPECT_EQ(numbers(map).size(), 40U);
  EXPECT_EQ(*numbers(map).begin(), 40U);
  std::size_t to_the_forgotten = 0;
  map.read_links([&](const sqlite::SavedLink& link) {
    EXPECT_EQ(link.session, 2);
    if (link.other < 40) ++to_the_forgotten;
    EXPECT_TRUE(link.place || link.other >= 40) << "a visit of what is forgotten";
  });
  EXPECT_GT(to_the_forgotten, 0U) << "which of tuesday's places are one is known as before";
  EXPECT_FALSE(map.thumbnail(0));
  EXPECT_TRUE(map.thumbnail(40));
  EXPECT_EQ(map.begin_session("monday", 0, ""), 3);
  (void)content(map);
  const std::string fault = setup_error([&] { map.forget("sunday"); });
  EXPECT_TRUE(says(fault, "there is no session 'sunday'; it has: tuesday, monday"));
}

TEST_F(Map, OfASessionThatRetiresVisitsAreKept) {
  make();
  MapFile map = open();
  const std::int64_t wednesday = map.begin_session("wednesday", 0, "");
  test::save_sample(map, wednesday, 0, 10);
  const std::vector<sqlite::SavedLink> more{{0, 30, std::nullopt, 41, .7},
                                            {0, 31, std::nullopt, 42, sqlite::person_accepted},
                                            {0, 32, std::nullopt, 43, .9}};
  map.save(wednesday, {.frames = 40, .links = more});
  const std::vector<sqlite::Successor> successors{
      {40, 80, .9}, {41, 81, .8}, {42, 82, .7}, {44, 84, .6}, {49, 85, .5}};
  std::map<std::uint64_t, std::uint64_t> frames;  // of tuesday, by place
  map.read([&](const sqlite::PlaceBlock& block) {
    for (const sqlite::PlaceRecord& record : block.records) {
      if (block.session == 2) frames[record.number] = record.frame;
    }
  });
  EXPECT_EQ(map.retire("tuesday", 40, 79, successors, 3), 3U) << "40 stands for 41 and 42";
  EXPECT_EQ(numbers(map).size(), 50U);
  EXPECT_FALSE(numbers(map).contains(40));
  EXPECT_FALSE(map.thumbnail(40));
  EXPECT_FALSE(map.statistics(2));
  const std::vector<sqlite::SessionFacts> sessions = map.sessions();
  ASSERT_EQ(sessions.size(), 3U);
  EXPECT_EQ(sessions[1].name, "tuesday");
  EXPECT_EQ(sessions[1].places, 0U);
  EXPECT_GT(sessions[1].frames, 40U);
  std::vector<sqlite::SavedLink> visits;
  const auto look = [&] {
    visits.clear();
    map.read_links([&](const sqlite::SavedLink& link) {
      if (link.session == 2) {
        EXPECT_FALSE(link.place);
      }
      if (link.other >= 80 && !link.place) visits.push_back(link);
    });
  };
  look();
  const std::vector<sqlite::SavedLink> expected{{3, 30, std::nullopt, 81, .7},
                                                {2, frames[40], std::nullopt, 80, .9},
                                                {2, frames[44], std::nullopt, 84, .6},
                                                {2, frames[49], std::nullopt, 85, .5}};
  EXPECT_EQ(visits, expected) << "what led to 41 leads to what stands for it";
  std::size_t words = 0;
  map.read_links([&words](const sqlite::SavedLink& link) {
    if (link.other == 42 && link.probability == sqlite::person_accepted) ++words;
  });
  EXPECT_EQ(words, 1U) << "a person's word stays as it was said";
  (void)content(map);
  map.compact();
  look();
  EXPECT_EQ(visits, expected);
  (void)content(map);
  {
    MapFile copy = MapFile::open(file("copy.seqloop"), test::sample_form());
    (void)copy.add(map);
    EXPECT_EQ(copy.sessions()[1].frames, sessions[1].frames);
    (void)content(copy);
  }
  map.forget("tuesday");
  look();
  EXPECT_EQ(visits, (std::vector<sqlite::SavedLink>{expected[0]}));
  (void)content(map);
}

TEST_F(Map, OfASessionAStretchMayRetire) {
  make();
  MapFile map = open();
  std::set<std::uint64_t> left = numbers(map);
  const std::vector<sqlite::Successor> successors{{5, 70, .9}, {7, 70, .9}, {20, 71, .8}};
  EXPECT_EQ(map.retire("monday", 7, 26, successors, 1), 2U);
  for (std::uint64_t place = 7; place <= 26; ++place) left.erase(place);
  EXPECT_EQ(numbers(map), left);
  EXPECT_EQ(map.sessions()[0].places, 20U);
  EXPECT_TRUE(map.statistics(1));
  map.read([](const sqlite::PlaceBlock& block) {
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(block.places.subspan(i * 200, 200),
                                     test::sample_place(block.records[i].number)));
    }
  });
  (void)content(map);
  EXPECT_EQ(map.retire("monday", 0, 39, {}, 1), 0U);
  EXPECT_EQ(map.sessions()[0].places, 0U);
  (void)content(map);
  EXPECT_EQ(map.retire("monday", 0, 39, {}, 1), 0U) << "there is nothing left";
  (void)content(map);
}

TEST_F(Map, PackingKeepsWhatPlacesAreLinkedTo) {
  make();
  MapFile map = open();
  const auto linked = [&map] {
    std::vector<sqlite::SavedLink> links;
    map.read_links([&](const sqlite::SavedLink& link) {
      if (link.place) links.push_back(link);
    });
    return links;
  };
  map.forget("monday");
  const std::vector<sqlite::SavedLink> before = linked();
  ASSERT_TRUE(std::ranges::any_of(before, [](const auto& link) { return link.other < 40; }));
  map.compact();
  EXPECT_EQ(linked(), before) << "they say which of tuesday's places are one";
}

TEST_F(Map, TakesInAnotherBehindItsOwn) {
  make();
  make("other.seqloop");
  MapFile map = open();
  {
    MapFile other = MapFile::open(file("other.seqloop"), std::nullopt);
    other.save(2, {.frames = 44, .removed = std::vector<std::uint64_t>{41, 3}});
    EXPECT_EQ(map.add(other), 80U);
  }
  const std::vector<sqlite::SessionFacts> sessions = map.sessions();
  ASSERT_EQ(sessions.size(), 4U);
  EXPECT_EQ(sessions[2].name, "monday 2");
  EXPECT_EQ(sessions[3].places, 39U);
  EXPECT_EQ(map.next_place(), 160U);
  EXPECT_EQ(map.thumbnail(150)->jpeg, test::sample_place(70, 700));
  EXPECT_EQ(map.statistics(4), map.statistics(2));
  std::vector<sqlite::SavedLink> links;
  map.read_links([&links](const sqlite::SavedLink& link) { links.push_back(link); });
  ASSERT_EQ(links.size(), 32U);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(links[i + 16].other, links[i].other + 80);
    EXPECT_EQ(links[i + 16].session, links[i].session + 2);
  }
  (void)content(map);
  sqlite::MapForm form = test::sample_form();
  form.describer = "another";
  MapFile unlike = MapFile::open(file("unlike"), form);
  EXPECT_TRUE(says(setup_error([&] { unlike.add(map); }), "cannot be compared"));
}

TEST_F(Map, SaysWhatIsWrongWithAFile) {
  make();
  const auto refused = [](const fs::path& path) {
    const std::string message = setup_error([&] { (void)MapFile::read_only(path); });
    EXPECT_TRUE(says(message, path.filename().string()));
    return message;
  };
  EXPECT_TRUE(says(refused(file("none")), "there is no such map"));
  EXPECT_TRUE(says(refused(folder_.path()), "is no file"));
  EXPECT_TRUE(
      says(refused(file(std::string(300, 'x'))), "cannot be looked at: File name too long"));
  EXPECT_TRUE(says(refused(folder_.write("empty", "")), "is empty"));
  EXPECT_TRUE(says(refused(folder_.write("text", std::string(9000, 'x'))), "no SeqLoop map"));
  std::string bytes = test::read_all(file());
  bytes[68] = 'T';
  EXPECT_TRUE(says(refused(folder_.write("foreign", bytes)), "no SeqLoop map"));
  bytes[68] = 'S';
  bytes[63] = 2;
  EXPECT_TRUE(says(refused(folder_.write("newer", bytes)), "a newer SeqLoop"));
  bytes[63] = 0;
  EXPECT_TRUE(says(refused(folder_.write("older", bytes)), "is none of a map"));
  bytes[63] = 1;
  const auto at = bytes.find("int8 euclidean");
  bytes[at] = 'I';
  EXPECT_TRUE(says(refused(folder_.write("flipped", bytes)), "is damaged; `seqloop map recover`"));
  const std::string none = setup_error([&] { (void)MapFile::open(file("none"), std::nullopt); });
  EXPECT_TRUE(says(none, "there is no such map"));
  EXPECT_FALSE(fs::exists(file("none")));
  sqlite::MapForm form = test::sample_form();
  form.descriptor_size = 6;
  const std::string other = setup_error([&] { (void)MapFile::open(file(), form); });
  EXPECT_TRUE(says(other, "descriptor size 5 and not 6"));
  MapFile read = MapFile::read_only(file());
  EXPECT_THROW(read.save(2, {}), sqlite::SaveError);
}

TEST_F(Map, ThatHoldsNothingTakesAnotherForm) {
  sqlite::MapForm form = test::sample_form();
  form.describer = "another";
  { const MapFile map = MapFile::open(file(), form); }
  {
    MapFile map = open();
    EXPECT_EQ(map.form(), test::sample_form());
    (void)map.begin_session("killed", 7, "");
  }
  {
    MapFile map = MapFile::open(file(), form);
    EXPECT_EQ(map.form(), form);
    EXPECT_TRUE(map.holds_nothing());
    EXPECT_EQ(content(map).substr(0, 2), "0 ");
  }
  {
    MapFile map = open();
    test::save_sample(map, map.begin_session("monday", 7, ""), 0, 5);
    EXPECT_FALSE(map.holds_nothing());
  }
  EXPECT_TRUE(says(setup_error([&] { (void)MapFile::open(file(), form); }), "described by"));
  {
    MapFile map = open();
    map.forget("monday");
  }
  MapFile map = MapFile::open(file(), form);
  EXPECT_EQ(map.next_place(), 5U) << "numbers are for ever";
  EXPECT_EQ(map.sessions().size(), 1U);
  EXPECT_EQ(map.check(), std::vector<std::string>());
}

TEST_F(Map, NamesTheBlockThatIsDamaged) {
  make();
  std::string bytes = test::read_all(file());
  const std::vector<std::byte> place = test::sample_place(57);
  const std::string text(reinterpret_cast<const char*>(place.data()), place.size());
  const auto at = bytes.find(text);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] ^= 1;
  const MapFile map = MapFile::read_only(folder_.write("bad", bytes));
  const std::string fault = setup_error([&] { map.read([](const sqlite::PlaceBlock&) {}); });
  EXPECT_TRUE(says(fault, "the block from place 50 of session 'tuesday' is damaged"));
  std::vector<std::string> told;
  std::size_t places = 0;
  map.read([&](const sqlite::PlaceBlock& block) { places += block.records.size(); },
           [&](const std::string& what) { told.push_back(what); });
  EXPECT_EQ(places, 70U);
  EXPECT_EQ(told.size(), 1U);
  EXPECT_EQ(map.check().size(), 1U);
}

TEST_F(Map, WhatAReaderSeesStaysWhileAnotherWrites) {
  make();
  MapFile map = open();
  test::save_sample(map, 2, 44, 3);
  const MapFile before = MapFile::read_only(file());
  const std::string seen = content(before);
  test::save_sample(map, 2, 48, 3);
  EXPECT_EQ(content(before), seen);
  EXPECT_NE(content(), seen);
}

TEST_F(Map, ADiskThatIsFullCostsNothingThatWasSaved) {
  make();
  test::RecordingVfs disk("nothing");
  MapFile map = open();
  const std::string before = content(map);
  std::size_t failures = 0;
  for (const What what : {What::write, What::sync}) {
    for (std::size_t works = 0; works < 1000; ++works) {
      std::size_t calls = 0;
      disk.refuse = [&](What asked) {
        if (asked != what || calls++ < works) return SQLITE_OK;
        return what == What::write ? SQLITE_FULL : SQLITE_IOERR_FSYNC;
      };
      try {
        map.save(2, {.frames = 44, .removed = std::vector<std::uint64_t>{500}});
        break;
      } catch (const sqlite::SaveError& error) {
        EXPECT_TRUE(says(error.what(), what == What::write ? "the disk is full" : "cannot be"));
        ++failures;
      }
      disk.refuse = {};
      ASSERT_EQ(content(map), before) << works;
      ASSERT_EQ(content(MapFile::read_only(file())), before) << works;
    }
  }
  disk.refuse = {};
  EXPECT_GT(failures, 3U);
  test::save_sample(map, 2, 44, 30);
  EXPECT_EQ(map.next_place(), 110U);
  EXPECT_EQ(numbers(map).size(), 110U);
}

TEST_F(Map, ForWhichThereIsNoRoomLeavesNoFile) {
  test::RecordingVfs disk("nothing");
  disk.refuse = [](What what) { return what == What::write ? SQLITE_FULL : SQLITE_OK; };
  EXPECT_TRUE(says(setup_error([this] { (void)open(); }), "the disk is full"));
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  folder_.write("map.seqloop", "");
  EXPECT_TRUE(says(setup_error([this] { (void)open(); }), "the disk is full"));
  EXPECT_TRUE(fs::exists(file())) << "it is somebody else's";
}

TEST_F(Map, ReadersGoOnWhileTheDiskStalls) {
  make();
  test::RecordingVfs disk("nothing");
  const std::string before = content();
  MapFile map = open();
  std::size_t stalls = 0;
  disk.refuse = [&](What what) {
    if (what != What::sync) return SQLITE_OK;
    ++stalls;
    EXPECT_EQ(content(), before);
    return SQLITE_OK;
  };
  test::save_sample(map, 2, 44, 30);
  disk.refuse = {};
  EXPECT_EQ(stalls, 1U);
  EXPECT_NE(content(), before);
}

/// Runs `work` in a process of its own, up to the moment in which it would leave, and then until
/// it is killed.
class Other {
 public:
  template <class Work>
  explicit Other(Work work) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    child_ = ::fork();
    if (child_ == 0) {
      const auto done = [&ends](bool well) {
        const char answer = well ? 'y' : 'n';
        (void)!::write(ends[1], &answer, 1);
        while (true) ::pause();
      };
      try {
        work(done);
        done(true);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        done(false);
      }
    }
    ::close(ends[1]);
    char answer = 'n';
    (void)!::read(ends[0], &answer, 1);
    ::close(ends[0]);
    well_ = answer == 'y';
  }
  Other(const Other&) = delete;
  Other& operator=(const Other&) = delete;
  Other(Other&&) = delete;
  Other& operator=(Other&&) = delete;
  ~Other() {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  [[nodiscard]] pid_t process() const { return child_; }
  [[nodiscard]] bool well() const { return well_; }

 private:
  pid_t child_ = -1;
  bool well_ = false;
};

TEST_F(Map, IsWrittenByOneProcessAtATime) {
  make();
  const std::string before = content();
  {
    const Other other([this](const auto& done) {
      MapFile map = open();
      test::save_sample(map, 2, 44, 3);
      done(true);
    });
    ASSERT_TRUE(other.well());
    const std::string fault = setup_error([this] { (void)open(); });
    EXPECT_TRUE(says(fault, "process " + std::to_string(other.process()) + " on "));
    EXPECT_TRUE(says(fault, "meanwhile `run` and `match` can read it (--read-only)"));
    EXPECT_NE(content(), before);
  }
  MapFile map = open();
  EXPECT_EQ(map.sessions()[1].frames, 48U);
}

TEST_F(Map, TakesNothingFromTheLogOfOneThatHadItsName) {
  make();
  const std::string before = content();
  {
    const Other other([this](const auto& done) {
      MapFile map = MapFile::open(file("killed"), test::sample_form());
      test::save_sample(map, map.begin_session("lost", 7, ""), 0, 5);
      done(true);
    });
    ASSERT_TRUE(other.well());
  }
  EXPECT_NE(content(MapFile::read_only(file("killed"))), before) << "with its own log";
  fs::copy_file(file(), file("killed"), fs::copy_options::overwrite_existing);
  const auto refusal = [](const std::string& message) {
    return says(message, "killed-wal: is not the log of the map beside it");
  };
  EXPECT_TRUE(refusal(setup_error([&] { (void)MapFile::read_only(file("killed")); })));
  EXPECT_TRUE(refusal(setup_error([&] { (void)MapFile::open(file("killed"), {}); })));
  EXPECT_EQ(sqlite::recover(file("killed"), file("out")).places, 80U);
  fs::remove(file("killed-wal"));
  EXPECT_EQ(content(MapFile::read_only(file("killed"))), before);
}

TEST_F(Map, IsNotBegunBesideWhatIsLeftOfOneThatIsGone) {
  make();
  {
    const Other other([this](const auto& done) {
      MapFile map = open();
      test::save_sample(map, 2, 44, 3);
      done(true);
    });
    ASSERT_TRUE(other.well());
  }
  const std::string saved = content();
  fs::rename(file(), file("elsewhere"));
  const std::string fault = setup_error([this] { (void)open(); });
  EXPECT_TRUE(
      says(fault, file("map.seqloop-wal").string() + ": belongs to a map that is there no more"));
  EXPECT_FALSE(fs::exists(file())) << "nothing is made";
  fs::rename(file("elsewhere"), file());
  EXPECT_EQ(content(), saved) << "it is put back";

  // Nor where the name leads to its own, or an empty file has it.
  fs::rename(file(), file("elsewhere"));
  fs::create_symlink("map.seqloop", file("link"));
  const auto by_link = [this] { (void)MapFile::open(file("link"), test::sample_form()); };
  EXPECT_TRUE(says(setup_error(by_link), "map.seqloop-wal: belongs to a map"));
  std::ofstream(file()).close();
  EXPECT_TRUE(says(setup_error(by_link), "map.seqloop-wal: belongs to a map"));
  EXPECT_TRUE(says(setup_error([this] { (void)open(); }), "map.seqloop-wal: belongs to a map"));
  fs::remove(file("link"));
  fs::rename(file("elsewhere"), file());
  EXPECT_EQ(content(), saved);

  // Of a log that was begun, and of an empty journal, nothing is lost.
  fs::rename(file(), file("elsewhere"));
  fs::copy_file(file("map.seqloop-wal"), file("elsewhere-wal"));
  fs::resize_file(file("map.seqloop-wal"), 32 + 24);
  std::ofstream(file().string() + "-journal");
  (void)open();
  EXPECT_EQ(content(MapFile::read_only(file("elsewhere"))), saved);
  fs::remove(file());
  std::ofstream(file().string() + "-journal") << test::journal_of(3);
  EXPECT_TRUE(says(setup_error([this] { (void)open(); }), "-journal: belongs to a map"));
}

TEST_F(Map, IsRefusedForItsNameAndNotForAJournalThatCannotBe) {
  const fs::path longest = file(std::string(250, 'm'));
  const std::string fault = setup_error([&] { (void)MapFile::open(longest, test::sample_form()); });
  EXPECT_FALSE(fault.empty());
  EXPECT_FALSE(says(fault, "belongs to a map")) << fault;
}

TEST_F(Map, IsBegunAnewWhereItsMakingWasCutShort) {
  std::string unsynced = test::journal_of(3);
  unsynced.replace(0, 8, 8, '\0');
  const fs::path journal = file().string() + "-journal";
  for (const std::string& left :
       {test::journal_of(0), unsynced, test::journal_of(3).substr(0, 19)}) {
    for (const bool is_empty : {true, false}) {
      if (is_empty) std::ofstream(file()).close();
      std::ofstream(journal) << left;
      EXPECT_EQ(open().sessions().size(), 0U);
      EXPECT_FALSE(fs::exists(journal));
      fs::remove(file());
    }
  }
}

TEST_F(Map, ThatIsNoMoreWhereItWasSavesNothing) {
  make();
  const std::string before = content();
  const auto refused = [](MapFile& map) {
    try {
      test::save_sample(map, 2, 60, 3);
    } catch (const sqlite::SaveError& error) {
      return std::string(error.what());
    }
    return std::string("it has saved");
  };
  {
    MapFile map = open();
    fs::rename(file(), file("elsewhere"));
    EXPECT_TRUE(says(refused(map), "removed, moved or replaced"));
    fs::rename(file("elsewhere"), file());
    test::save_sample(map, 2, 44, 3);
    EXPECT_NE(content(), before) << "it is back";
  }
  // Of another map that has come to its place, nothing is touched.
  std::optional<MapFile> old = open();
  test::save_sample(*old, 2, 48, 3);
  fs::remove(file());
  EXPECT_TRUE(
      says(setup_error([this] { (void)open(); }), "belongs to a map that is there no more"));
  fs::remove(file("map.seqloop-wal"));
  const Other other([this](const auto& done) {
    MapFile map = open();
    test::save_sample(map, map.begin_session("new", 7, ""), 0, 5);
    done(true);
  });
  ASSERT_TRUE(other.well());
  EXPECT_TRUE(says(refused(*old), "removed, moved or replaced"));
  old.reset();
  EXPECT_EQ(MapFile::read_only(file()).sessions().back().places, 5U);
}

TEST_F(Map, IsReadFromAFolderThatNobodyMayWriteTo) {
  make();
  const std::string closed = content();
  fs::copy(file(), file("killed.seqloop"));
  {
    const Other other([this](const auto& done) {
      MapFile map = MapFile::open(file("killed.seqloop"), std::nullopt);
      test::save_sample(map, 2, 44, 3);
      done(true);
    });
    ASSERT_TRUE(other.well());
  }
  ASSERT_TRUE(fs::exists(file("killed.seqloop-wal")));
  fs::remove(file("killed.seqloop-shm"));
  fs::permissions(folder_.path(), fs::perms(0555));
  {
    const Other other([&](const auto& done) {
      if (::getuid() == 0 && ::setuid(65534) != 0) throw std::runtime_error("cannot be anybody");
      std::string fault;
      const bool same = test::content_of(MapFile::read_only(file()), fault) == closed;
      const std::string text = test::content_of(MapFile::read_only(file("killed.seqloop")), fault);
      std::string refused;
      try {
        (void)open();
      } catch (const SetupError& error) {
        refused = error.what();
      }
      done(same && fault.empty() && text.starts_with("83 ") &&
           refused.find("rights") != std::string::npos);
    });
    EXPECT_TRUE(other.well());
  }
  fs::permissions(folder_.path(), fs::perms(0755));
}

/// Writes over a map as `compact` does, so that pages of it are changed on the disk, and leaves it
/// and its journal as a kill at that moment would: beside it, under another name.
void leave_half_written(const fs::path& from, const fs::path& to) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(from.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database,
                         "PRAGMA journal_mode = DELETE; PRAGMA cache_size = 1; BEGIN IMMEDIATE;"
                         "UPDATE block SET places = zeroblob(length(places))",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  for (const char* tail : {"", "-journal"}) fs::copy(from.string() + tail, to.string() + tail);
  sqlite3_close(database);
}

TEST_F(Map, WhoseWriterWasKilledWhileItRewroteTheFileIsReadAsItWas) {
  make();
  const std::string before = content();
  const fs::path killed = file("killed.seqloop");
  ASSERT_NO_FATAL_FAILURE(leave_half_written(file(), killed));
  const auto journal = killed.string() + "-journal";
  ASSERT_GT(fs::file_size(journal), 512U) << "pages that are to be put back";
  EXPECT_EQ(content(MapFile::read_only(killed)), before);
  EXPECT_FALSE(fs::exists(journal));
}

TEST_F(Map, WhoseWriterWasKilledSaysSoWhereItMayNotBeWritten) {
  make();
  const fs::path killed = file("killed.seqloop");
  ASSERT_NO_FATAL_FAILURE(leave_half_written(file(), killed));
  fs::permissions(folder_.path(), fs::perms(0555));
  {
    const Other other([&killed](const auto& done) {
      if (::getuid() == 0 && ::setuid(65534) != 0) throw std::runtime_error("cannot be anybody");
      std::string refused;
      try {
        (void)MapFile::read_only(killed);
      } catch (const SetupError& error) {
        refused = error.what();
      }
      done(says(refused, "was killed") && says(refused, "seqloop map recover"));
    });
    EXPECT_TRUE(other.well());
  }
  fs::permissions(folder_.path(), fs::perms(0755));
  EXPECT_GT(fs::file_size(killed.string() + "-journal"), 512U);
}

TEST_F(Map, OfTheFirstReleaseIsRead) {
  make();
  const MapFile map = MapFile::read_only(SEQLOOP_SAMPLE_MAPS "/version_1.seqloop");
  EXPECT_EQ(content(map), content());
  EXPECT_EQ(map.form(), test::sample_form());
}

}  // namespace
}  // namespace seqloop
