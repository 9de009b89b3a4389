// SPDX-License-Identifier: MIT
// `seqloop map` as a user calls it.
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program/program.hpp"
#include "sqlite/sample_map.hpp"

namespace seqloop {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;

class MapVerb : public test::Program {
 protected:
  void make(const std::string& name, std::size_t places = 10) const {
    MapFile map = MapFile::open(file(name), test::sample_form());
    for (const char* session : {"monday", "tuesday"}) {
      const std::int64_t id = map.begin_session(session, 1'700'000'000'000'000'000, "k = 10");
      for (std::uint64_t i = 0; i < 4; ++i)
        test::save_sample(map, id, i * (places + 1), places, {}, std::nullopt, true);
    }
  }

  [[nodiscard]] std::string content(const std::string& name) const {
    std::string fault;
    std::string text = test::content_of(MapFile::read_only(file(name)), fault);
    EXPECT_EQ(fault, "");
    return text;
  }

  void change(const std::string& name, const std::string& sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file(name).c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }

  /// Flips a bit of a place's bytes, of which there are 200, or of its thumbnail's 700.
  void damage(const std::string& name, std::uint64_t place, std::size_t size = 200) const {
    std::string bytes = test::read_all(file(name));
    const std::vector<std::byte> whole = test::sample_place(place, size);
    // A thumbnail's start is a JPEG file's.
    const auto at = bytes.find({reinterpret_cast<const char*>(whole.data()) + 3, whole.size() - 3});
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    folder_.write(name, bytes);
  }

  test::Outcome expect(int exit_code, const std::string& arguments,
                       const std::string& words) const {
    SCOPED_TRACE(arguments);
    const test::Outcome outcome = run("map " + arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos)
        << "no '" << words << "' in:\n"
        << outcome.out << outcome.err;
    return outcome;
  }

  test::Outcome expect_refused(const std::string& arguments, const std::string& words) const {
    const std::string before = listing();
    const test::Outcome outcome = expect(2, arguments, words);
    EXPECT_EQ(listing(), before) << arguments << " left something";
    return outcome;
  }
};

TEST_F(MapVerb, InfoSaysWhatIsInAMap) {
  make("a");
  expect(0, "info a", "80 places of 200 bytes, descriptors of 5 values");
  const auto json = nlohmann::json::parse(expect(0, "info a --json", "{").out);
  EXPECT_EQ(json["places"], 80);
  EXPECT_EQ(json["descriptor_size"], 5);
  EXPECT_EQ(json["sessions"].size(), 2U);
  EXPECT_EQ(json["sessions"][1]["name"], "tuesday");
  EXPECT_EQ(json["sessions"][1]["places"], 40);
  EXPECT_EQ(json["sessions"][1]["frames"], 44);
  EXPECT_EQ(json["file_bytes"], fs::file_size(file("a")));
  EXPECT_EQ(listing(), "a ");
}

// As a program that was killed leaves it, and one that is still at it.
TEST_F(MapVerb, InfoCountsTheLogThatTheMapStandsIn) {
  MapFile map = MapFile::open(file("a"), test::sample_form());
  const std::int64_t id = map.begin_session("monday", 1'700'000'000'000'000'000, "k = 10");
  test::save_sample(map, id, 0, 100);
  const auto json = nlohmann::json::parse(expect(0, "info a --json", "{").out);
  EXPECT_EQ(json["file_bytes"], fs::file_size(file("a")) + fs::file_size(file("a-wal")));
  EXPECT_GT(json["file_bytes"], 100 * 200);
  expect(0, "info a", " bytes with its log, ");
}

TEST_F(MapVerb, CheckNamesWhatIsDamagedAndRecoverLeavesItOut) {
  make("a");
  expect(0, "check a", "80 places in 2 sessions, all of them whole");
  damage("a", 57);
  expect_refused("check a", "a: the block from place 50 of session 'tuesday' is damaged; `seqloop");
  const auto outcome = expect(0, "recover a b", "b: 70 places in 2 sessions");
  EXPECT_NE(outcome.err.find("lost: session 'tuesday': 10 of 40 places"), std::string::npos);
  expect(0, "check b", "all of them whole");
  expect_refused("recover a b", "there is such a file already");
  damage("b", 60, 700);
  expect_refused("check b", "b: the thumbnail of place 60 is damaged");
  const auto pictures = expect(0, "recover b d", "d: 70 places in 2 sessions, 16 links, 7 thumb");
  EXPECT_NE(pictures.err.find("b: lost: 1 of 8 thumbnails"), std::string::npos) << pictures.err;
  EXPECT_EQ(pictures.err.find("links\n"), std::string::npos) << "all of them are there";
  folder_.write("text", std::string(20'000, 'x'));
  expect_refused("recover text c", "nothing of a map is whole in it");
  fs::resize_file(file("b"), 20'000);
  expect_refused("recover b c", "b: no place of it is whole");
  EXPECT_FALSE(exists("c"));
}

TEST_F(MapVerb, MergePutsMapsBehindEachOther) {
  make("a");
  make("b");
  expect(0, "merge a b --out c", "c: 160 places in 4 sessions");
  expect(0, "check c", "160 places in 4 sessions");
  EXPECT_EQ(listing().find("partial"), std::string::npos);
  expect_refused("merge a b --out b", "there is such a file already");
  expect_refused("merge a b --out none/c", "none/c: its folder does not exist; create ");
  expect_refused("merge a none --out d", "there is no such map");
  expect_refused("merge a --out d", "seqloop map merge A B");
  expect_refused("merge a b ./a --out d", "./a: the same map is named twice");
  expect(0, "merge a c --out e", "c: 80 is added to the numbers of its places");
  (void)MapFile::open(file("other"), sqlite::MapForm{"int8", "words", 7, 7});
  const auto refused = expect_refused("merge a none other --out d", "none: there is no such map");
  EXPECT_NE(expect_refused("merge a none --out a", "none: there is").err.find("a: there is such"),
            std::string::npos);
  EXPECT_NE(refused.err.find("other: its places cannot be compared with those of a: they are int8, "
                             "of 7 values, described by 'words'; those are"),
            std::string::npos)
      << refused.err;
  EXPECT_FALSE(exists("d"));
}

TEST_F(MapVerb, WhatAKilledOneLeftIsRemoved) {
  make("a");
  for (const char* tail : {"-wal", "-shm", ".copy", ".copy-wal"}) {
    folder_.write(".new.partial-12345" + std::string(tail), "left");
  }
  folder_.write(".new.partial-12345", "left");
  folder_.write(".newer.partial-12345-wal", "another's");
  expect(0, "recover a new", "new: 80 places");
  EXPECT_EQ(listing().find(".new.partial"), std::string::npos) << listing();
  EXPECT_TRUE(exists(".newer.partial-12345-wal"));
}

TEST_F(MapVerb, NothingIsMadeBesideWhatIsLeftOfAnotherMap) {
  make("a");
  make("b");
  folder_.write("new-journal", test::journal_of(3));
  const std::string words = "new-journal: belongs to a map that is there no more";
  expect_refused("merge a b --out new", words);
  expect_refused("recover a new", words);
  expect(0, "export a --out folder", "folder: 80 places");
  expect_refused("import folder --out new", words);
  EXPECT_FALSE(exists("new"));
  EXPECT_EQ(listing().find(".partial"), std::string::npos) << listing();
}

// SQLite would make the new map what the other was before its first page: empty.
TEST_F(MapVerb, WhatIsMadeBesideAMapWhoseMakingWasCutShortIsWhole) {
  make("a");
  make("b");
  expect(0, "export a --out folder", "folder: 80 places");
  for (const auto& [verb, places] : {std::pair{"merge a b --out new", "new: 160 places"},
                                     {"recover a new", "new: 80 places"},
                                     {"import folder --out new", "new: 80 places"}}) {
    SCOPED_TRACE(verb);
    folder_.write("new-journal", test::journal_of(0));
    expect(0, verb, places);
    EXPECT_FALSE(exists("new-journal"));
    EXPECT_GT(content("new").size(), content("a").size() - 1);
    fs::remove(file("new"));
  }
}

TEST_F(MapVerb, WhatIsExportedIsImportedAsItWas) {
  make("a");
  {
    MapFile map = MapFile::open(file("a"), std::nullopt);
    (void)map.begin_session("empty, \"quoted\"", 3, "");
    map.save(3, {.frames = 2, .removed = std::vector<std::uint64_t>{0, 44}});
  }
  expect(0, "export a --out folder", "folder: 78 places in 3 sessions");
  for (const char* name : {"map.json", "places.csv", "links.csv", "session-1.npy", "session-3.npy",
                           "thumbnail-10.jpg"}) {
    EXPECT_TRUE(exists(std::string("folder/") + name)) << name;
  }
  EXPECT_EQ(fs::file_size(file("folder/session-2.npy")), 128U + 39 * 200);
  expect(0, "import folder --out b", "b: 78 places in 3 sessions");
  EXPECT_EQ(content("b"), content("a"));
  expect_refused("import folder --out b", "there is such a file already");
  const std::string table = test::read_all(file("folder/places.csv"));
  const std::string json = test::read_all(file("folder/map.json"));
  const auto with = [](std::string text, std::string_view part, std::string_view other) {
    for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += other.size())
      text.replace(at, part.size(), other);
    return text;
  };
  folder_.write("folder/places.csv", "\xEF\xBB\xBF" + with(table, "\n", "\r\n"));
  expect(0, "import folder --out as-spreadsheets-write", "78 places in 3 sessions");
  EXPECT_EQ(content("as-spreadsheets-write"), content("a"));
  folder_.write("folder/places.csv", with(table, "\n2,1,", "\n1,1,"));
  expect_refused("import folder --out c", "places.csv:3: place 1 stands behind place 1 of its");
  folder_.write("folder/places.csv", with(table, "\n1,1,", "\n1,2,"));
  expect_refused("import folder --out c", "places.csv: place 1 of session 2 is not above place");
  folder_.write("folder/places.csv", table);
  folder_.write("folder/map.json", with(json, "tuesday", "monday"));
  expect_refused("import folder --out c", "map.json: two sessions have the name 'monday'; give");
  folder_.write("folder/map.json", "no");
  const auto both = expect_refused("import folder --out b", "map.json: is no JSON object");
  EXPECT_NE(both.err.find("b: there is such a file already"), std::string::npos) << both.err;
  folder_.write("folder/map.json", json);
  const std::string picture = test::read_all(file("folder/thumbnail-10.jpg"));
  for (const std::string wrong : {"", "\xFF\xD8", "<html>no picture</html>"}) {
    folder_.write("folder/thumbnail-10.jpg", wrong);
    expect_refused("import folder --out c", "folder/thumbnail-10.jpg: is no JPEG picture; replace");
  }
  folder_.write("folder/thumbnail-10.jpg", picture);
  fs::resize_file(file("folder/session-2.npy"), 5000);
  expect_refused("import folder --out c", "session-2.npy: its numbers are not");
  fs::remove(file("folder/places.csv"));
  expect_refused("import folder --out c", "places.csv");
  expect_refused("import none --out c", "none: is no folder; name a folder that `seqloop map exp");
}

/// An export of a map that is changed before it is imported.
class ImportedMap : public MapVerb {
 protected:
  void SetUp() override {
    make("a");
    expect(0, "export a --out folder", "80 places");
    json_ = nlohmann::json::parse(test::read_all(file("folder/map.json")));
  }

  /// A table of the export with a line in another's place. @param line from 1 on
  void with_line(const std::string& name, std::size_t line, const std::string& other) const {
    std::istringstream whole(test::read_all(file("folder/" + name)));
    std::string text;
    std::string row;
    for (std::size_t i = 1; std::getline(whole, row); ++i) {
      text += (i == line ? other : row) + '\n';
    }
    folder_.write("folder/" + name, text);
  }

  void expect_line_refused(const std::string& name, std::size_t line, const std::string& other,
                           const std::string& words) const {
    const std::string whole = test::read_all(file("folder/" + name));
    with_line(name, line, other);
    SCOPED_TRACE(other);
    const auto outcome = expect_refused("import folder --out c", words);
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    folder_.write("folder/" + name, whole);
  }

  void expect_json_refused(const std::string& pointer, const nlohmann::json& value,
                           const std::string& words) const {
    nlohmann::json json = json_;
    json[nlohmann::json::json_pointer(pointer)] = value;
    folder_.write("folder/map.json", json.dump());
    SCOPED_TRACE(pointer + ": " + value.dump());
    const auto outcome = expect_refused("import folder --out c", "folder/map.json: " + words);
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }

  nlohmann::json json_;
};

TEST_F(ImportedMap, ItsPlacesMustBeSuchAsRunTakes) {
  const auto refused = [this](std::size_t line, const std::string& row, const std::string& words) {
    expect_line_refused("places.csv", line, row,
                        "places.csv:" + std::to_string(line) + ": " + words);
  };
  refused(3, "1,1,0,0", "frame 0 of place 1 is not above frame 0 of place 0; list places");
  refused(12, "10,1,8,0", "frame 8 of place 10 is not above frame 9 of place 9");
  refused(3, "0,1,1,0", "place 0 stands behind place 0 of its session; list places in the order");
  refused(3, "1,77,1,0", "session 77 is not in map.json, which has 2 sessions");
  refused(3, "1,0,1,0", "session 0 is not in map.json");
  refused(3, "1,1,1", "3 cells under a header of 4");
  refused(3, "1,1,x,0", "'x' under 'frame' is not a whole number");
  refused(3, "1,1,-1,0", "'-1' under 'frame' is not a whole number");
  refused(3, "1,1,1,1e3", "'1e3' under 'time_ns' is not a whole number");
  refused(81, "4611686018427387904,2,42,0", "place 4611686018427387904 is too high; write one");
  // Of a frame that is too high, the next place cannot follow.
  expect_line_refused("places.csv", 3, "1,1,99999,0",
                      "places.csv:4: frame 2 of place 2 is not above frame 99999 of place 1");
  // A camera counts frames that were lost, too, and a session those that came.
  with_line("places.csv", 41, "39,1,99999,0");
  expect(0, "import folder --out c", "80 places in 2 sessions");
  expect(0, "check c", "all of them whole");
}

TEST_F(ImportedMap, ItsLinksMustBeSuchAsAMapHas) {
  const auto refused = [this](const std::string& row, const std::string& words) {
    expect_line_refused("links.csv", 3, row, "links.csv:3: " + words);
  };
  for (const std::string wrong : {"nan", "inf", "7", "-5", "-0.1"}) {
    for (const std::string where : {"1,0,0,0,0,", "1,10,1,0,0,"}) {
      refused(where + wrong, "its probability is " + wrong + "; write a number from 0 to 1, or");
    }
  }
  refused("1,0,0,0,0,2", "its probability is 2; write");
  refused("1,0,0,0,0,-1", "its probability is -1; write");
  refused("1,0,9,0,0,.5", "'9' under 'visit' is not 0 or 1");
  refused("77,0,1,0,0,.5", "session 77 is not in map.json, which has 2 sessions");
  refused("1,0,0,10,0,.5", "place 10 is frame 11 of its session, and not 0");
  refused("1,0,0,40,0,.5", "place 40 is of session 2, and not of 1");
  refused("1,10,1,5,0,.5", "a visit has no place of its own, and this has 5; write 0, or no visit");
  refused("1,10,1,0,4611686018427387904,.5", "place 4611686018427387904 is too high; write one");
  refused("1,4611686018427387904,1,0,0,.5", "frame 4611686018427387904 is too high; write one");
  refused("1,x,1,0,0,.5", "'x' under 'frame' is not a whole number");
  // A person's words; places that went, which links outlive.
  std::string links = test::read_all(file("folder/links.csv"));
  links += "1,0,1,0,0,2\n1,0,1,0,0,-1\n1,0,1,0,0,0\n1,0,1,0,999,.5\n1,77,0,888,999,.5\n";
  folder_.write("folder/links.csv", links);
  expect(0, "import folder --out c", "80 places in 2 sessions");
  std::size_t count = 0;
  MapFile::read_only(file("c")).read_links([&count](const sqlite::SavedLink&) { ++count; });
  EXPECT_EQ(count, 16U + 5U);
}

TEST_F(ImportedMap, WhatItSaysOfItselfIsLookedAt) {
  const std::string whole = "; write a whole number from 0 to 4611686018427387903";
  const std::string first = "/sessions/0/";
  expect_json_refused(first + "frames", -5, "'frames' of session 1 is -5" + whole);
  expect_json_refused(first + "frames", 18446744073709551611U,
                      "'frames' of session 1 is 18446744073709551611" + whole);
  expect_json_refused(first + "frames", 1.5, "'frames' of session 1 is 1.5" + whole);
  expect_json_refused(first + "frames", true, "'frames' of session 1 is true" + whole);
  expect_json_refused(first + "frames", "many", "'frames' of session 1 is \"many\"" + whole);
  expect_json_refused(first + "frames", nullptr, "'frames' of session 1 is null" + whole);
  expect_json_refused(first + "began_ns", 1e30, "'began_ns' of session 1 is 1e+30; write a whole");
  expect_json_refused(first + "name", 3, "'name' of session 1 is 3; write a text");
  expect_json_refused(first + "name", "", "session 1 has no name; give it one");
  expect_json_refused(first + "settings", {1}, "'settings' of session 1 is an array; write a text");
  expect_json_refused("/sessions/1", 7, "session 2 is 7; write an object");
  expect_json_refused("/sessions", 7, "'sessions' is 7; write an array of sessions");
  expect_json_refused("/form", 7, "'form' is 7; write a text");
  expect_json_refused("/place_bytes", 0,
                      "'place_bytes' is 0; write a whole number from 1 to 67108");
  expect_json_refused("/descriptor_size", -1, "'descriptor_size' is -1; write a whole number from");
  const std::string statistics = first + "statistics";
  const nlohmann::json three{1, 2, 3};
  expect_json_refused(statistics, 7, "'statistics' of session 1 is 7; write an object");
  expect_json_refused(statistics + "/frames", -1, "'frames' of the statistics of session 1 is -1");
  expect_json_refused(statistics + "/mean", three,
                      "'mean' of the statistics of session 1 has 3 values; write 5, as a "
                      "descriptor has");
  expect_json_refused(statistics + "/variance", three, "'variance' of the statistics of session 1");
  expect_json_refused(
      statistics + "/variance/1", -1e-9,
      "a value of 'variance' of the statistics of session 1 is -1e-09; write a number from "
      "0 to 1.16e+77");
  expect_json_refused(statistics + "/variance/1", nullptr,
                      "a value of 'variance' of the statistics of ses");
  expect_json_refused(statistics + "/mean/1", 1e39,
                      "a value of 'mean' of the statistics of session "
                      "1 is 1e+39; write a number from -3.4e+38 to 3.4e+38");
  expect_json_refused(statistics + "/mean/1", "x",
                      "a value of 'mean' of the statistics of session 1 is");
  for (const char* key : {"form", "describer", "descriptor_size", "place_bytes", "sessions"}) {
    nlohmann::json json = json_;
    json.erase(key);
    folder_.write("folder/map.json", json.dump());
    expect_refused("import folder --out c",
                   "folder/map.json: there is no '" + std::string(key) + "'; name a folder that");
  }
  folder_.write("folder/map.json", "{\"sessions\": [{\"frames\": NaN}]}");
  expect_refused("import folder --out c", "map.json: is no JSON object: parse error at line 1");
}

TEST_F(ImportedMap, AllThatIsWrongWithItIsToldAtOnce) {
  const auto told = [this](const std::vector<std::string>& all) {
    const std::string err = expect_refused("import folder --out a", "").err;
    for (const std::string& words : all) {
      EXPECT_NE(err.find(words), std::string::npos) << "no '" << words << "' in:\n" << err;
    }
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(err, '\n')), all.size()) << err;
  };
  with_line("places.csv", 3, "1,1,0,0");
  with_line("places.csv", 5, "3,1,x,-1e");
  with_line("links.csv", 2, "1,0,0,0,0,nan");
  fs::remove(file("folder/session-2.npy"));
  folder_.write("folder/thumbnail-10.jpg", "no picture");
  json_["sessions"][0]["frames"] = -5;
  json_["sessions"][1]["name"] = "monday";
  json_["descriptor_size"] = "five";
  folder_.write("folder/map.json", json_.dump());
  told({"a: there is such a file already", "map.json: 'descriptor_size' is \"five\"",
        "map.json: 'frames' of session 1 is -5", "map.json: two sessions have the name 'monday'",
        "places.csv:3: ", "places.csv:5: 'x'", "places.csv:5: '-1e'",
        "links.csv:2: ", "session-2.npy: cannot be read", "thumbnail-10.jpg: is no JPEG picture"});

  // Of many alike, a handful.
  for (std::size_t line = 2; line < 12; ++line) with_line("links.csv", line, "1,0,0,0,0,nan");
  EXPECT_NE(expect_refused("import folder --out a", "").err.find("links.csv: and 5 more like"),
            std::string::npos);
}

TEST_F(MapVerb, LinksOfNoSessionAreNamedByExport) {
  {
    MapFile map = MapFile::open(file("a"), test::sample_form());
    for (const char* session : {"monday", "tuesday"}) {
      const std::int64_t id = map.begin_session(session, 7, "");
      const std::vector<sqlite::SavedLink> visits{{id, 3, std::nullopt, 5, 0.9}};
      map.save(id, {.frames = 4, .links = visits});
    }
  }
  change("a", "DELETE FROM session WHERE id = 1");
  expect_refused("export a --out x", "a: a link belongs to no session");
}

TEST_F(MapVerb, ForgetAndCompactMakeItSmaller) {
  make("a", 300);
  const auto whole = fs::file_size(file("a"));
  const auto visits = [this] {
    const auto json = nlohmann::json::parse(expect(0, "info a --json", "{").out);
    std::size_t sum = 0;
    for (const auto& session : json["sessions"]) sum += session["visits"].get<std::size_t>();
    return sum;
  };
  EXPECT_EQ(visits(), 8U);
  expect(0, "forget a monday", "a: 1200 places in 1 session in ");
  EXPECT_EQ(visits(), 0U) << "all were of monday";
  expect(0, "compact a", "a: 1200 places in 1 session in ");
  EXPECT_LT(fs::file_size(file("a")), whole * 6 / 10);
  expect(0, "check a", "1200 places in 1 session, all");
  expect_refused("forget a monday", "there is no session 'monday'; it has: tuesday");
  expect_refused("compact none", "there is no such map");
  expect_refused("compact .", ".: is no file; name a map");
  EXPECT_EQ(listing(), "a ");
}

TEST_F(MapVerb, SessionsWhoseNamesAreNoUtf8AreExportedAndImported) {
  MapFile::open(file("a"), test::sample_form()).begin_session("caf\xe9", 3, "\xff");
  expect(0, "info a --json", "caf\xef\xbf\xbd");
  expect(0, "export a --out folder", "folder: 0 places in 1 session");
  expect(0, "import folder --out b", "b: 0 places in 1 session");
  EXPECT_EQ(MapFile::read_only(file("b")).sessions().front().name, "caf\xef\xbf\xbd");
}

TEST_F(MapVerb, NamesThatLookLikeFlagsStandBehindTwoDashes) {
  {
    MapFile map = MapFile::open(file("-a"), test::sample_form());
    for (const char* session : {"-x", "--json", "--"}) map.begin_session(session, 3, "");
  }
  expect(0, "forget -- -a -x", "-a: 0 places in 2 sessions");
  expect(0, "forget -- -a --json", "-a: 0 places in 1 session");
  expect(0, "forget -- -a --", "-a: 0 places in 0 sessions");
  expect(0, "info --json -- -a", "\"places\": 0");
  EXPECT_EQ(run("plan -- -x").exit_code, 2);
}

TEST_F(MapVerb, SaysHowItIsUsed) {
  EXPECT_NE(run("map --help").out.find("seqloop map recover DAMAGED NEW"), std::string::npos);
  expect_refused("", "what is to be done with it?");
  expect_refused("inf a", "did you mean 'info'?");
  expect_refused("info", "seqloop map info FILE");
  expect_refused("info a b", "2 names after it");
  expect_refused("info a --out b", "map info does not take it");
  expect_refused("check a --json", "only map info takes it");
  expect_refused("info a --jsn", "did you mean --json?");
  folder_.write("empty", "");
  expect_refused("info empty", "is empty: nothing was saved in it");
}

}  // namespace
}  // namespace seqloop
