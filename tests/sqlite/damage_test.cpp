// SPDX-License-Identifier: MIT
// Maps with flipped bits, cut off, with pages that are swapped, empty or of other databases: they
// are refused, or what is wrong is named; and what is whole is recovered.
#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <set>

#include "expect_setup_error.hpp"
#include "pages_in_circles.hpp"
#include "seqloop/sqlite/recover.hpp"
#include "sqlite/database.hpp"
#include "sqlite/recording_vfs.hpp"
#include "sqlite/sample_map.hpp"
#include "sqlite/schema.hpp"
#include "temporary_folder.hpp"

namespace seqloop {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;

constexpr std::size_t page = 8192;
constexpr std::size_t place_bytes = 200;

fs::path in_memory() {
  return fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
}

/// A map, and on which pages each of its blocks is.
class Sample {
 public:
  Sample() {
    const fs::path path = folder_.path() / "sample.seqloop";
    {
      MapFile map = MapFile::open(path, test::sample_form());
      for (const char* session : {"monday", "tuesday", "wednesday"}) {
        const std::int64_t id = map.begin_session(session, 7, "k = 10");
        std::uint64_t frames = 0;
        for (const std::size_t places : {5U, 20U, 35U, 90U, 1U, 200U}) {
          test::save_sample(map, id, frames, places);
          blocks_.push_back({frames, {}, {}});
          frames += places;
          for (std::size_t i = 0; i < places; ++i) {
            blocks_.back().places.push_back(map.next_place() - places + i);
          }
        }
      }
      content_ = test::content_of(map, fault_);
    }
    bytes_ = test::read_all(path);
    for (Block& block : blocks_) find(block);
  }

  struct Block {
    std::uint64_t frame;  ///< of its first place
    std::vector<std::uint64_t> places;
    std::set<std::size_t> pages;
  };
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] const std::string& content() const { return content_; }
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  /// Looks for the first bytes of each record and the bytes of each place. Those that are split
  /// between two pages lie beside others that are not.
  void find(Block& block) const {
    const auto look_for = [&](std::string_view part) {
      const auto at = bytes_.find(part);
      if (at == std::string::npos) return;
      block.pages.insert(at / page);
      block.pages.insert((at + part.size() - 1) / page);
    };
    for (const std::uint64_t number : block.places) {
      const std::vector<std::byte> place = test::sample_place(number);
      look_for({reinterpret_cast<const char*>(place.data()), place.size()});
      const auto time = static_cast<std::int64_t>(number) * 40 - 100;
      std::string record(16, '\0');
      const std::uint64_t frame = block.frame + number - block.places.front();
      std::memcpy(record.data(), &frame, 8);
      std::memcpy(record.data() + 8, &time, 8);
      look_for(record);
    }
  }

  test::TemporaryFolder folder_{in_memory()};
  std::vector<Block> blocks_;
  std::string bytes_;
  std::string content_;
  std::string fault_;
};

struct Damage {
  std::string what;
  std::string bytes;
  std::set<std::size_t> pages;  ///< that are not as they were
};

Damage damage(const std::string& whole, const std::string& foreign, std::mt19937_64& random) {
  Damage made{"", whole, {}};
  const std::size_t pages = whole.size() / page;
  const auto any = [&random](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  const auto touch = [&made, whole](std::size_t first, std::size_t last) {
    for (std::size_t i = first / page; i <= last / page; ++i) made.pages.insert(i);
  };
  switch (any(7)) {
    case 0: {
      const std::size_t bits = std::size_t{1} << any(8);
      made.what = std::to_string(bits) + " bits";
      for (std::size_t i = 0; i < bits; ++i) {
        const std::size_t at = any(whole.size());
        made.bytes[at] = static_cast<char>(made.bytes[at] ^ (1 << any(8)));
        touch(at, at);
      }
      break;
    }
    case 1: {
      made.what = "headers of pages";
      for (std::size_t i = 0; i < 1 + any(3); ++i) {
        const std::size_t at = any(pages) * page + any(110);
        made.bytes[at] = static_cast<char>(any(256));
        touch(at, at);
      }
      break;
    }
    case 2: {
      const std::size_t left = any(whole.size());
      made.what = "cut off at " + std::to_string(left);
      made.bytes.resize(left);
      touch(left, whole.size() - 1);
      break;
    }
    case 3: {
      const std::size_t a = any(pages);
      const std::size_t b = any(pages);
      made.what = "swapped pages";
      std::swap_ranges(made.bytes.begin() + static_cast<std::ptrdiff_t>(a * page),
                       made.bytes.begin() + static_cast<std::ptrdiff_t>((a + 1) * page),
                       made.bytes.begin() + static_cast<std::ptrdiff_t>(b * page));
      touch(a * page, a * page);
      touch(b * page, b * page);
      break;
    }
    case 4: {
      const std::size_t at = any(whole.size());
      const std::size_t size = 1 + any(std::min(whole.size() - at, 3 * page));
      made.what = "zeros";
      std::fill_n(made.bytes.begin() + static_cast<std::ptrdiff_t>(at), size, '\0');
      touch(at, at + size - 1);
      break;
    }
    case 5: {
      const std::size_t at = any(pages) * page;
      made.what = "a page of another database";
      std::copy_n(foreign.begin() + static_cast<std::ptrdiff_t>(any(foreign.size() / page) * page),
                  page, made.bytes.begin() + static_cast<std::ptrdiff_t>(at));
      touch(at, at);
      break;
    }
    default: {
      const std::size_t at = any(2) == 0 ? 60 + any(12) : any(100);
      made.what = "another kind or version";
      made.bytes[at] = static_cast<char>(any(256));
      touch(at, at);
    }
  }
  return made;
}

/// What opening, checking and reading says; empty when nothing is found to be wrong.
std::string faults_of(const fs::path& file, bool write, std::string& content) {
  std::string fault;
  try {
    const MapFile map = write ? MapFile::open(file, std::nullopt) : MapFile::read_only(file);
    content = test::content_of(map, fault);
  } catch (const SetupError& error) {
    fault = error.what();
    EXPECT_TRUE(test::says(fault, "damaged.seqloop"));
    EXPECT_TRUE(test::says(fault, "; ")) << "nothing to do about it";
  } catch (const sqlite::SaveError& error) {
    fault = error.what();
  }
  return fault;
}

/// The numbers of what was recovered; each place must be what was saved.
std::set<std::uint64_t> recovered(const fs::path& file, const fs::path& out) {
  std::set<std::uint64_t> numbers;
  try {
    (void)sqlite::recover(file, out);
  } catch (const SetupError& error) {
    EXPECT_TRUE(test::says(error.what(), "; "));
    return numbers;
  }
  const MapFile map = MapFile::read_only(out);
  for (const std::string& wrong : map.check()) ADD_FAILURE() << wrong;
  map.read([&](const sqlite::PlaceBlock& block) {
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      const std::uint64_t number = block.records[i].number;
      numbers.insert(number);
      EXPECT_TRUE(std::ranges::equal(block.places.subspan(i * place_bytes, place_bytes),
                                     test::sample_place(number)));
    }
  });
  return numbers;
}

class MapDamage : public testing::TestWithParam<unsigned> {};

TEST_P(MapDamage, IsNamedAndWhatIsWholeIsRecovered) {
  const test::RecordingVfs fast("nothing");
  const Sample sample;
  ASSERT_EQ(sample.fault(), "");
  std::string foreign;
  {
    const test::TemporaryFolder folder(in_memory());
    const fs::path path = folder.path() / "foreign.db";
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    sqlite3_exec(database,
                 "PRAGMA page_size = 8192; CREATE TABLE block(a, b); CREATE TABLE map(a TEXT);"
                 "INSERT INTO block VALUES(1, zeroblob(30000)), ('x', 2.5); CREATE INDEX i ON "
                 "block(a);",
                 nullptr, nullptr, nullptr);
    sqlite3_close(database);
    foreign = test::read_all(path);
  }
  std::mt19937_64 random(GetParam());
  std::size_t named = 0;
  for (std::size_t i = 0; i < SEQLOOP_DAMAGED_FILES && !testing::Test::HasFailure(); ++i) {
    const test::TemporaryFolder folder(in_memory());
    const Damage made = damage(sample.bytes(), foreign, random);
    SCOPED_TRACE("file " + std::to_string(i) + ": " + made.what);
    const fs::path file = folder.write("damaged.seqloop", made.bytes);
    const std::set<std::uint64_t> numbers = recovered(file, folder.path() / "out.seqloop");
    for (const Sample::Block& block : sample.blocks()) {
      const auto touched = [&made](std::size_t p) { return made.pages.contains(p); };
      if (std::ranges::any_of(block.pages, touched)) continue;
      for (const std::uint64_t place : block.places) {
        EXPECT_TRUE(numbers.contains(place)) << "place " << place << " is whole";
      }
    }
    std::string content;
    const std::string fault = faults_of(file, i % 4 == 0, content);
    if (fault.empty()) {
      EXPECT_TRUE(content == sample.content()) << "it is damaged and nothing was said:\n"
                                               << content.substr(0, 300);
    } else {
      ++named;
    }
  }
  std::printf("%d files, of %zu something was said\n", SEQLOOP_DAMAGED_FILES, named);
  EXPECT_GT(named, static_cast<std::size_t>(SEQLOOP_DAMAGED_FILES) / 2);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MapDamage, testing::Range(1U, 11U));

void change(const fs::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

TEST(MapInCircles, EndsWhereRowsComeAgain) {
  const test::TemporaryFolder folder(in_memory());
  const Sample sample;
  const auto read_all = [](const MapFile& map) { map.read([](const sqlite::PlaceBlock&) {}); };
  const std::initializer_list<std::pair<const char*, std::function<void(const MapFile&)>>> reads{
      {"session", [](const MapFile& map) { (void)map.sessions(); }},
      {"block", read_all},
      {"removed", read_all},
      {"link", [](const MapFile& map) { map.read_links([](const sqlite::SavedLink&) {}); }},
      {"thumbnail",
       [](const MapFile& map) { map.read_thumbnails([](const sqlite::SavedThumbnail&) {}); }},
      {"thumbnail", [](const MapFile& map) { (void)map.thumbnail_facts(); }}};
  for (const auto& [table, read] : reads) {
    SCOPED_TRACE(table);
    const fs::path file = folder.write(table, sample.bytes());
    change(file, "INSERT INTO removed VALUES(99, " +
                     std::to_string(sqlite::row_checksum("removed", std::int64_t{99})) + ")");
    test::lead_in_circles(file, table);
    const MapFile map = MapFile::read_only(file);
    const auto read_it = [&map, &one = read] { one(map); };
    EXPECT_TRUE(test::says(test::setup_error(read_it), "the same rows come again"));
  }
}

TEST(MapInCircles, IsWorkedOnNoLongerThanItHasRoomForRows) {
  const test::TemporaryFolder folder(in_memory());
  const Sample sample;
  using Work = std::function<void(MapFile&)>;
  const std::initializer_list<std::pair<const char*, Work>> works{
      {"check", [](MapFile& map) { (void)map.check(); }},
      {"forget", [](MapFile& map) { map.forget("monday"); }},
      {"compact", [](MapFile& map) { map.compact(); }},
      {"retire", [](MapFile& map) { (void)map.retire("monday", 1, 4, {}, 1); }},
      {"save", [](MapFile& map) {
         test::save_sample(map, map.sessions().back().id, 400, 5, {1, 2, 3});
       }}};
  for (const char* table :
       {"session", "statistics", "block", "removed", "link", "thumbnail", "holder", "map"}) {
    for (const auto& [name, work] : works) {
      SCOPED_TRACE(std::string(table) + ", " + name);
      const fs::path file = folder.write("circles", sample.bytes());
      test::lead_in_circles(file, table, 6);
      // What they find is up to which rows they need; that they end is what is asked here.
      try {
        MapFile map = MapFile::open(file, std::nullopt);
        work(map);
      } catch (const SetupError&) {
      } catch (const sqlite::SaveError&) {
      }
      for (const char* tail : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + tail);
    }
  }
}

TEST(MapInCircles, SaysSo) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path file = folder.write("circles", Sample().bytes());
  test::lead_in_circles(file, "link", 6);
  MapFile map = MapFile::open(file, std::nullopt);
  try {
    (void)map.retire("monday", 1, 4, {}, 1);
    FAIL() << "it has come to the end of what has none";
  } catch (const sqlite::SaveError& error) {
    EXPECT_TRUE(
        test::says(error.what(), "damaged (it has more rows than there is room for in it)"));
  }
}

TEST(MapWithoutItsSessions, IsNotTakenForEmpty) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path file = folder.write("map", Sample().bytes());
  change(file, "DELETE FROM session");
  sqlite::MapForm form = test::sample_form();
  form.describer = "another";
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)MapFile::open(file, form); }), "another"));
  const MapFile map = MapFile::open(file, std::nullopt);
  EXPECT_FALSE(map.holds_nothing());
  EXPECT_TRUE(test::says(test::setup_error([&] { map.read([](const sqlite::PlaceBlock&) {}); }),
                         "the table of sessions is damaged"));
}

TEST(MapRecovery, NeedsAMap) {
  const test::TemporaryFolder folder(in_memory());
  const std::string refused = test::setup_error([&] {
    (void)sqlite::recover(folder.write("text", std::string(50'000, 'x')), folder.path() / "out");
  });
  EXPECT_TRUE(test::says(refused, "nothing of a map is whole in it"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

TEST(MapRecovery, WritesOverNothing) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path map = folder.path() / "map";
  const fs::path other = folder.path() / "other";
  for (const fs::path& file : {map, other}) {
    MapFile made = MapFile::open(file, test::sample_form());
    test::save_sample(made, made.begin_session("a", 0, ""), 0, 5);
  }
  fs::create_symlink(map, folder.path() / "link");
  for (const fs::path& out : {map, folder.path() / "link", other}) {
    const std::string refused = test::setup_error([&] { (void)sqlite::recover(map, out); });
    EXPECT_TRUE(test::says(refused, "there is such a file already")) << out;
  }
  for (const fs::path& file : {map, other}) {
    EXPECT_EQ(MapFile::read_only(file).sessions().size(), 1U);
  }
}

/// A map of sessions with five places each. @return what the map knows of the last
sqlite::SessionFacts make(const fs::path& file, std::initializer_list<const char*> names) {
  MapFile map = MapFile::open(file, test::sample_form());
  for (const char* name : names) test::save_sample(map, map.begin_session(name, 0, ""), 0, 5);
  return map.sessions().back();
}

/// The names of sessions in what is recovered, which is all places.
std::vector<std::string> recovered_names(const fs::path& file, const fs::path& out) {
  static_cast<void>(sqlite::recover(file, out));
  const MapFile map = MapFile::read_only(out);
  std::vector<std::string> names;
  for (const sqlite::SessionFacts& facts : map.sessions()) {
    EXPECT_EQ(facts.places, 5U);
    names.push_back(facts.name);
  }
  return names;
}

TEST(MapWithDamagedThumbnails, TakesNoDriveWhosePlacesItCouldNotSave) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "map";
  make(file, {"a"});
  std::int64_t root = 0;
  {
    sqlite::Database database(file, SQLITE_OPEN_READONLY);
    root = database.number("SELECT rootpage FROM sqlite_master WHERE name = 'thumbnail'");
  }
  std::string bytes = test::read_all(file);
  const auto begin = static_cast<std::size_t>(root - 1) * page;
  ASSERT_LT(begin, bytes.size());
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), page, '\x55');
  folder.write("map", bytes);
  MapFile map = MapFile::open(file, std::nullopt);
  EXPECT_TRUE(test::says(
      test::setup_error([&] { static_cast<void>(map.begin_session("b", 0, "")); }), "damaged"));
  EXPECT_EQ(map.sessions().size(), 1U);
}

TEST(MapRecovery, EndsWhereItIsToldTo) {
  const test::TemporaryFolder folder;
  make(folder.path() / "map", {"a", "b"});
  int calls = 0;
  const auto end = [&] {
    if (++calls == 3) throw std::runtime_error("interrupted");
  };
  EXPECT_THROW(
      static_cast<void>(sqlite::recover(folder.path() / "map", folder.path() / "out", end)),
      std::runtime_error);
  EXPECT_EQ(calls, 3) << "once before, and with each block";
}

TEST(MapRecovery, MakesUpNamesThatAreFree) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path file = folder.path() / "map.seqloop";
  make(file, {"recovered 2", "b", "c", "recovered 3"});
  change(file, "UPDATE session SET checksum = checksum + 1 WHERE id IN (2, 3)");
  EXPECT_EQ(
      recovered_names(file, folder.path() / "out"),
      (std::vector<std::string>{"recovered 2", "recovered 2 2", "recovered 3 2", "recovered 3"}));
}

TEST(MapRecovery, CopiesTwoSessionsOfOneName) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path file = folder.path() / "map.seqloop";
  sqlite::SessionFacts facts = make(file, {"a", "b"});
  facts.name = "a";
  change(file, "UPDATE session SET name = 'a', checksum = " +
                   std::to_string(sqlite::session_sum(facts, test::sample_form())) +
                   " WHERE id = 2");
  EXPECT_EQ(recovered_names(file, folder.path() / "out"), (std::vector<std::string>{"a", "a 2"}));
}

TEST(MapRecovery, TakesTheLogWithTheFile) {
  const test::TemporaryFolder folder(in_memory());
  const fs::path file = folder.path() / "map.seqloop";
  const fs::path killed = folder.path() / "killed.seqloop";
  {
    MapFile map = MapFile::open(file, test::sample_form());
    test::save_sample(map, map.begin_session("a", 0, ""), 0, 60);
    for (const char* tail : {"", "-wal"}) fs::copy(file.string() + tail, killed.string() + tail);
  }
  EXPECT_EQ(sqlite::recover(killed, folder.path() / "out").places, 60U);
  EXPECT_TRUE(fs::exists(killed.string() + "-wal"));
  EXPECT_FALSE(fs::exists(folder.path() / "out.copy"));
}

/// A map without places, and in a log the eight batches of ten that a killed writer saved after
/// them.
class KilledMap {
 public:
  static constexpr std::size_t batches = 8;

  KilledMap() {
    const fs::path open = folder_.path() / "open.seqloop";
    { MapFile::open(open, test::sample_form()).begin_session("a", 0, ""); }
    MapFile map = MapFile::open(open, std::nullopt);
    for (std::size_t i = 0; i < batches; ++i) {
      test::save_sample(map, 1, 11 * i, 10);
      ends.push_back(fs::file_size(open.string() + "-wal"));
    }
    fs::copy(open, file);
    log = test::read_all(open.string() + "-wal");
    write(log);
  }

  void write(const std::string& bytes) const { folder_.write("killed.seqloop-wal", bytes); }

  /// How many places are read; what is said instead of them.
  [[nodiscard]] std::string read(bool to_write) const {
    try {
      const MapFile map = to_write ? MapFile::open(copy(), {}) : MapFile::read_only(copy());
      return std::to_string(map.sessions().at(0).places);
    } catch (const SetupError& error) {
      return error.what();
    }
  }

  [[nodiscard]] std::uint64_t recovered() const {
    const fs::path out = folder_.path() / "out";
    fs::remove(out);
    return sqlite::recover(file, out).places;
  }

 private:
  test::TemporaryFolder folder_{in_memory()};

 public:
  const fs::path file = folder_.path() / "killed.seqloop";
  std::string log;
  std::vector<std::size_t> ends;  ///< bytes of the log after each batch

 private:
  /// Opening changes it.
  [[nodiscard]] fs::path copy() const {
    const fs::path to = folder_.path() / "copy.seqloop";
    for (const char* tail : {"", "-wal"}) {
      fs::copy(file.string() + tail, to.string() + tail, fs::copy_options::overwrite_existing);
    }
    fs::remove(to.string() + "-shm");
    return to;
  }
};

TEST(MapLog, ThatIsCutOffHasLostItsLastBatchOnly) {
  const KilledMap map;
  for (std::size_t bytes = 0; bytes <= map.log.size(); bytes += 1000) {
    SCOPED_TRACE(bytes);
    std::string torn = map.log.substr(0, bytes);
    const auto whole = static_cast<std::size_t>(
        std::ranges::count_if(map.ends, [&](std::size_t end) { return end <= bytes; }));
    if (whole < 1) continue;
    map.write(torn);
    EXPECT_EQ(map.read(false), std::to_string(10 * whole));
    // What was on its way to the disk stands there in part.
    torn.resize(map.log.size());
    map.write(torn);
    EXPECT_EQ(map.read(true), std::to_string(10 * whole));
  }
}

TEST(MapLog, DamagedBetweenItsBatchesIsNamedAndRecovered) {
  const KilledMap map;
  EXPECT_EQ(map.read(false), "80");
  EXPECT_EQ(map.recovered(), 80U);
  constexpr std::size_t head = 32;
  constexpr std::size_t frame = 24 + page;
  std::size_t named = 0;
  std::uint64_t most = 0;
  for (std::size_t first = 0; first < map.log.size(); first = first < head ? head : first + frame) {
    for (const std::size_t in : {1U, 9U, 17U, 26U, 4000U}) {
      if (first + in >= (first < head ? head : map.log.size())) continue;
      SCOPED_TRACE(first + in);
      std::string bytes = map.log;
      bytes[first + in] ^= 4;
      map.write(bytes);
      const auto before = static_cast<std::size_t>(
          std::ranges::count_if(map.ends, [&](std::size_t end) { return end <= first; }));
      for (const bool to_write : {false, true}) {
        const std::string said = map.read(to_write);
        if (before + 2 < KilledMap::batches) {
          EXPECT_TRUE(test::says(said, "copy.seqloop-wal: is damaged"));
          EXPECT_TRUE(test::says(said, "seqloop map recover"));
        } else if (before + 2 > KilledMap::batches) {
          EXPECT_EQ(said, std::to_string(10 * before)) << "it may have been cut off";
        }
      }
      if (before + 2 >= KilledMap::batches) continue;
      ++named;
      const std::uint64_t found = map.recovered();
      EXPECT_GE(found, 10 * before);
      most = std::max(most, found);
    }
  }
  EXPECT_GT(named, 50U);
  EXPECT_EQ(most, 80U) << "of what was damaged once most was written again";
}

}  // namespace
}  // namespace seqloop
