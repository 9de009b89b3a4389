// SPDX-License-Identifier: MIT
// Maps that last, through the real binary.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/oracle.hpp"
#include "core/ways.hpp"
#include "platform/pictures.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"
#include "sqlite/sample_map.hpp"

namespace seqloop {
namespace {

class LastingMaps : public test::Program {
 protected:
  void SetUp() override {
    write("first.npy", oracle::drive(1, 120, 40, 0.2F));
    write("again.npy", oracle::drive(1, 120, 40, 0.4F));
    write("other.npy", oracle::drive(2, 90, 40, 0.2F));
  }

  void write(const std::string& name, const oracle::Vectors& rows) const {
    files::NpyWriter writer(file(name), rows.front().size());
    for (const auto& row : rows) writer.append(row);
    writer.commit();
  }

  void expect_done(const std::string& arguments) const {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << '\n' << outcome.err;
  }

  void expect_refused(const std::string& arguments, const std::string& words) const {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }

  [[nodiscard]] std::vector<nlohmann::json> lines(const std::string& name) const {
    std::istringstream text(test::read_all(file(name)));
    std::vector<nlohmann::json> all;
    for (std::string line; std::getline(text, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }

  /// Accepted answers of a run, each checked: it names the session and the frame that it should.
  [[nodiscard]] std::size_t found(const std::string& name, const std::string& session,
                                  std::size_t first_place) const {
    std::size_t matches = 0;
    for (const auto& line : lines(name)) {
      for (const auto& answer : line["answers"]) {
        if (answer["status"] != "match") continue;
        ++matches;
        EXPECT_EQ(answer["session"], session);
        EXPECT_EQ(answer["match"].get<std::size_t>(),
                  first_place + answer["session_frame"].get<std::size_t>());
        EXPECT_NEAR(answer["session_frame"].get<double>(), answer["frame"].get<double>(), 2.0);
      }
    }
    return matches;
  }
};

TEST_F(LastingMaps, NothingIsWrittenUnderTheNamesOfAMapsOwnFiles) {
  const std::string words = "belongs to the map m.seqloop";
  expect_refused("match --query first.npy --map m.seqloop --out m.seqloop-wal", words);
  expect_done("run --source first.npy --map m.seqloop --out f.jsonl");
  for (const char* const tail : {"-wal", "-shm", "-journal"}) {
    expect_refused(
        "run --source again.npy --map m.seqloop --read-only --out a --summary ./m.seqloop" +
            std::string(tail),
        words.substr(0, 19));
    expect_refused("report f.jsonl --out m.seqloop" + std::string(tail), words);
  }
  expect_done("match --query first.npy --out other.npy-wal");
}

TEST_F(LastingMaps, ADriveFindsWhatEarlierRunsHaveSaved) {
  expect_done("run --source other.npy --map m.seqloop --session other --out o.jsonl");
  expect_done("run --source first.npy --map m.seqloop --session first --out f.jsonl");
  EXPECT_EQ(lines("f.jsonl").back()["saved"].is_number(), true);
  EXPECT_EQ(found("f.jsonl", "", 0), 0U);
  expect_done("run --source again.npy --map m.seqloop --read-only --out r.jsonl");
  const std::string before = test::read_all(file("m.seqloop"));
  EXPECT_GT(found("r.jsonl", "first", 90), 60U);
  expect_done("match --query again.npy --map m.seqloop --read-only --out m.csv");
  EXPECT_EQ(test::read_all(file("m.seqloop")), before) << "only read";
  const test::Outcome last = run("run --source again.npy --map m.seqloop --out l.jsonl");
  EXPECT_EQ(last.exit_code, 0);
  EXPECT_NE(last.err.find("330 places now; 120 frames are saved"), std::string::npos) << last.err;
  EXPECT_GT(found("l.jsonl", "first", 90), 60U);
}

TEST_F(LastingMaps, AMatchListIsTheSameAsFromTheRun) {
  expect_done("match --query first.npy --map a.seqloop --out a.csv");
  expect_done("run --source first.npy --map b.seqloop --out b.jsonl");
  expect_done("match --query again.npy --map a.seqloop --out a.csv");
  expect_done("match --query again.npy --map b.seqloop --out b.csv");
  EXPECT_EQ(test::read_all(file("a.csv")), test::read_all(file("b.csv")));
  EXPECT_GT(test::read_all(file("a.csv")).size(), 5'000U);
}

TEST_F(LastingMaps, ADiskThatIsFullStopsTheSavingAndNothingElse) {
  const test::Outcome full =
      run("--version; trap '' XFSZ; ulimit -f 400; '" SEQLOOP_BINARY
          "' run --source first.npy --map m.seqloop --pace live --fps 200 --save-every-s 0.1");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.err.find("not all of the drive is saved"), std::string::npos) << full.err;
  // Which frames it takes is up to the machine; a slow one may lose the last.
  EXPECT_NE(full.out.find("\"status\":\"ended\""), std::string::npos) << "the run went on";
  // What had been saved is there, as many places as were told, and the rest has room again.
  const std::string places = run("map info m.seqloop").out;
  EXPECT_NE(full.err.find("the map has " + places.substr(0, places.find(" of ")) + " now"),
            std::string::npos)
      << full.err << places;
  expect_done("run --source again.npy --map m.seqloop --out l.jsonl");
}

TEST_F(LastingMaps, WhereAllFramesAreSavedWhatIsMissingIsNamed) {
  write("long.npy", oracle::drive(1, 600, 40, 0.2F));
  const auto with_room_for = [this](int kilobytes) {
    std::filesystem::remove(file("m.seqloop"));
    // All is saved at the end, so that the same bytes are written on each machine.
    return run("--version; trap '' XFSZ; ulimit -f " + std::to_string(kilobytes) +
               "; '" SEQLOOP_BINARY
               "' match --query long.npy --map m.seqloop --save-every-s 3600 --out m.csv");
  };
  int too_little = 56;
  int enough = 2'000;
  ASSERT_NE(with_room_for(too_little).exit_code, 0);
  ASSERT_EQ(with_room_for(enough).exit_code, 0);
  while (enough - too_little > 1) {
    const int middle = (too_little + enough) / 2;
    (with_room_for(middle).exit_code == 0 ? enough : too_little) = middle;
  }
  // The frames come first: what had no room is the last that was learnt.
  const test::Outcome full = with_room_for(too_little);
  EXPECT_NE(full.err.find("600 frames are saved"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("not all of the drive is saved: its frames are, and not all that was "
                          "learnt of them (links, thumbnails, statistics); m.seqloop: "),
            std::string::npos)
      << full.err;
}

TEST_F(LastingMaps, WhatTheFileHasNoRoomForStaysInTheLogAndIsTold) {
  // The log of a drive of 40 frames is smaller than the file.
  write("large.npy", oracle::drive(1, 600, 2'000, 0.2F));
  write("small.npy", oracle::drive(1, 40, 2'000, 0.3F));
  expect_done("match --query large.npy --map m.seqloop --out m.csv");
  const auto kilobytes = std::filesystem::file_size(file("m.seqloop")) / 1024;
  const test::Outcome full =
      run("--version; trap '' XFSZ; ulimit -f " + std::to_string(kilobytes + 4) +
          "; '" SEQLOOP_BINARY "' match --query small.npy --map m.seqloop --session 2 --out m.csv");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.err.find("m.seqloop-wal: has to stay beside the map, which is none "
                          "without it: m.seqloop: "),
            std::string::npos)
      << full.err;
  EXPECT_NE(full.err.find("40 frames are saved"), std::string::npos) << full.err;
  EXPECT_TRUE(std::filesystem::exists(file("m.seqloop-wal")));
  expect_done("map check m.seqloop");
  expect_done("match --query small.npy --map m.seqloop --session 3 --out m.csv");
  EXPECT_FALSE(std::filesystem::exists(file("m.seqloop-wal")));
  const auto info = nlohmann::json::parse(run("map info m.seqloop --json").out);
  ASSERT_EQ(info["sessions"].size(), 3U);
  EXPECT_EQ(info["sessions"][1]["frames"], 40);
}

TEST_F(LastingMaps, OfSessionsThatWereSeenOftenEnoughVisitsStay) {
  std::string last;
  for (unsigned n = 0; n < 8; ++n) {
    const std::string number = std::to_string(n);
    write("drive.npy", oracle::drive(1, 300, 40, 0.1F + 0.01F * static_cast<float>(n)));
    last = run("match --query drive.npy --map m.seqloop --session s" + number + " --out m.csv").err;
  }
  EXPECT_NE(last.find("the map has 1800 places now"), std::string::npos) << last;
  EXPECT_NE(last.find("of 's1' 300 places went"), std::string::npos) << last;
  expect_done("map check m.seqloop");
  const auto info = nlohmann::json::parse(run("map info m.seqloop --json").out);
  const auto& sessions = info["sessions"];
  ASSERT_EQ(sessions.size(), 8U);
  for (std::size_t n = 0; n < 8; ++n) {
    SCOPED_TRACE(n);
    EXPECT_EQ(sessions[n]["frames"], 300);
    EXPECT_EQ(sessions[n]["places"], n < 2 ? 0 : 300);
    EXPECT_EQ(sessions[n]["visits"].get<int>() > 10, n < 2) << sessions[n]["visits"];
  }
  expect_done("map export m.seqloop --out folder");
  std::istringstream links(test::read_all(file("folder/links.csv")));
  std::size_t visits = 0;
  for (std::string line; std::getline(links, line);) {
    std::vector<double> cells;  // session, frame, visit, place, other, probability
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(std::atof(cell.c_str()));
    if (cells.at(2) != 1.0) continue;
    ++visits;
    EXPECT_LE(cells[0], 2.0) << line;
    EXPECT_GE(cells[4], 600.0) << line << ": a place that is there";
    const double frame = std::fmod(cells[4], 300.0);
    EXPECT_NEAR(frame, cells[1], 20.0) << line << ": the same spot";
    EXPECT_GE(cells[5], 0.5) << line;
  }
  EXPECT_EQ(visits,
            sessions[0]["visits"].get<std::size_t>() + sessions[1]["visits"].get<std::size_t>());
  expect_done("map import folder --out again.seqloop");
  const auto again = nlohmann::json::parse(run("map info again.seqloop --json").out);
  EXPECT_EQ(again["sessions"], sessions);
}

/// A revisit of 40 frames that see little is likely, but may as well be a place that looks alike.
TEST_F(LastingMaps, NothingIsLinkedOfADriveOfWhichNoLoopIsAccepted) {
  const oracle::Vectors way = test::way(3, 300, 4.0F, 1);
  const oracle::Vectors again = test::way(3, 300, 4.0F, 2);
  for (const std::ptrdiff_t frames : {40, 150}) {
    SCOPED_TRACE(frames);
    oracle::Vectors drive = way;
    drive.insert(drive.end(), again.begin() + 100, again.begin() + 100 + frames);
    write("drive.npy", drive);
    const std::string map = std::to_string(frames);
    expect_done("run --source drive.npy --standardise off --out l.jsonl --map " + map);
    const std::string told = test::read_all(file("l.jsonl"));
    const bool accepted = told.find(R"("status":"match")") != std::string::npos;
    expect_done("map export " + map + " --out of-" + map);
    const std::string links = test::read_all(file("of-" + map + "/links.csv"));
    const auto visits = std::ranges::count(links, '\n') - 1;
    EXPECT_EQ(accepted, frames == 150);
    EXPECT_EQ(visits, frames == 150 ? 150 : 0);
  }
}

TEST_F(LastingMaps, ADriveOfManyLapsShrinks) {
  oracle::Vectors laps;
  for (unsigned n = 0; n < 9; ++n) {
    const auto lap = oracle::drive(1, 300, 40, 0.1F + 0.01F * static_cast<float>(n));
    laps.insert(laps.end(), lap.begin(), lap.end());
  }
  write("laps.npy", laps);
  const std::string end =
      run("match --query laps.npy --map m.seqloop --session day --out m.csv").err;
  EXPECT_NE(end.find("the map has 1800 places now; 2700 frames"), std::string::npos) << end;
  EXPECT_NE(end.find("of 'day' 900 places went"), std::string::npos) << end;
  expect_done("map check m.seqloop");
  const auto info = nlohmann::json::parse(run("map info m.seqloop --json").out);
  EXPECT_EQ(info["places"], 1800);
  EXPECT_EQ(info["sessions"][0]["frames"], 2700);
  EXPECT_GT(info["sessions"][0]["visits"], 30);
  write("next.npy", oracle::drive(1, 300, 40, 0.3F));
  expect_done("run --source next.npy --map m.seqloop --read-only --out n.jsonl");
  std::size_t matches = 0;
  for (const auto& line : lines("n.jsonl")) {
    for (const auto& answer : line["answers"]) matches += answer["status"] == "match" ? 1U : 0U;
  }
  EXPECT_GT(matches, 200U) << "it is known from what is left";
  expect_done("match --query laps.npy --map all.seqloop --grow all --out m.csv");
  EXPECT_EQ(nlohmann::json::parse(run("map info all.seqloop --json").out)["places"], 2700);
}

TEST_F(LastingMaps, EachPlaceHasAThumbnailUnlessThatIsSwitchedOff) {
  test::write_pictures(folder_, "drive", 40);
  expect_done("run --source drive --map with.seqloop --session one --out with.jsonl");
  expect_done("run --source drive --map without.seqloop --thumbnails off --out without.jsonl");
  const auto info = [&](const std::string& name) {
    return nlohmann::json::parse(run("map info " + name + " --json").out);
  };
  EXPECT_EQ(info("with.seqloop")["places"], 40);
  EXPECT_EQ(info("with.seqloop")["thumbnails"], 40);
  EXPECT_GT(info("with.seqloop")["thumbnail_bytes"], 40 * 200);
  EXPECT_EQ(info("without.seqloop")["thumbnails"], 0);
  expect_done("map check with.seqloop");
  expect_done("run --source drive --map with.seqloop --read-only --out map.jsonl");
  expect_done("run --source drive --reference with.seqloop --out reference.jsonl");
  const auto answers = [this](const std::string& name) {
    std::vector<nlohmann::json> all;
    for (const auto& line : lines(name)) all.push_back(line["answers"]);
    return all;
  };
  EXPECT_EQ(answers("reference.jsonl"), answers("map.jsonl"));
  EXPECT_EQ(answers("map.jsonl").size(), 40U);
  expect_refused("run --source drive --reference with.seqloop --map without.seqloop",
                 "to localise in a map: --map with.seqloop --read-only");
  expect_done("describe --source drive --out drive.npy");
  expect_refused("match --query drive.npy --reference with.seqloop --out m.csv", "to localise in");
  for (const char* how : {"", " --read-only"}) {
    expect_refused(
        "match --query drive.npy --out m.csv --map with.seqloop" + std::string(how),
        "; `seqloop run --source PICTURES --map FILE` describes them as the map's were, and a "
        ".npy file does not say how its own were");
  }
  expect_done("run --source drive --map with.seqloop --session two --out again.jsonl");
  EXPECT_EQ(info("with.seqloop")["thumbnails"], 80);
  EXPECT_FALSE(exists("drawn"));
  const test::Outcome drawn =
      run("run --source drive --map with.seqloop --read-only --exclude 5 --pictures drawn");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("difference_matrix.png, matches.png"), std::string::npos) << drawn.err;
  const cv::Mat sheet = cv::imread(file("drawn/matches.png"));
  EXPECT_GT(sheet.cols, 2 * 320) << "a frame and a place, both as wide";
  expect_done("run --source again.npy --reference first.npy --out n.jsonl --pictures drawn");
  EXPECT_FALSE(std::filesystem::exists(file("drawn/matches.png"))) << "it was another run's";
  const test::Outcome unseen =
      run("run --source drive --map without.seqloop --read-only --pictures plain "
          "--out drive/plain.jsonl");
  EXPECT_EQ(unseen.exit_code, 0) << unseen.err;
  EXPECT_NE(unseen.err.find("no matched pictures"), std::string::npos) << unseen.err;
  EXPECT_NE(unseen.err.find("40 frames: "), std::string::npos) << "what it writes is no frame";
  expect_done("map export with.seqloop --out exported");
  for (const char* name : {"exported/thumbnail-0.jpg", "exported/thumbnail-79.jpg"}) {
    const cv::Mat picture = cv::imread(file(name), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.cols, 48) << name << ": every other pixel of 96";
    EXPECT_EQ(picture.rows, 32) << name;
  }
  expect_done("map forget with.seqloop one");
  EXPECT_EQ(info("with.seqloop")["thumbnails"], 40);
}

// A session that nobody named is called by its date.
TEST_F(LastingMaps, APlaceAndItsSessionHaveRoomOverItsPicture) {
  test::write_pictures(folder_, "drive", 40);
  expect_done("run --source drive --map m.seqloop --out one.jsonl");
  expect_done("run --source drive --map m.seqloop --read-only --pictures drawn --out two.jsonl");
  const cv::Mat sheet = cv::imread(file("drawn/matches.png"));
  constexpr int gap = 6;
  constexpr int pair = 2 * 320 + 3 * gap;
  ASSERT_EQ(sheet.cols, 2 * pair);
  const cv::Mat between = sheet(cv::Rect(pair - gap, 0, gap, 24));
  EXPECT_EQ(cv::norm(between, cv::Mat(between.size(), between.type(), cv::Scalar::all(255)),
                     cv::NORM_INF),
            0.0)
      << "the caption is cut off";
}

TEST_F(LastingMaps, APoseGraphHasTheDrivesOwnLoops) {
  expect_done("run --source first.npy --map m.seqloop --out f.jsonl");
  // Two laps of another road, and the road of the map.
  oracle::Vectors drive = oracle::drive(2, 90, 40, 0.2F);
  const auto add = [&drive](const oracle::Vectors& more) {
    drive.insert(drive.end(), more.begin(), more.end());
  };
  add(oracle::drive(2, 90, 40, 0.3F));
  add(oracle::drive(1, 120, 40, 0.4F));
  write("laps.npy", drive);
  std::string odometry;
  for (std::size_t n = 0; n <= drive.size(); ++n) {
    odometry += std::to_string(n) + " " + std::to_string(n) + " 0 0 0 0 0 1\n";
  }
  std::ofstream(file("o.tum")) << odometry;
  const test::Outcome outcome =
      run("run --source laps.npy --map m.seqloop --fps 1 --exclude 40 --odometry o.tum "
          "--pose-graph g.g2o --out l.jsonl");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::size_t own = 0;
  std::size_t earlier = 0;
  for (const auto& line : lines("l.jsonl")) {
    for (const auto& answer : line["answers"]) {
      if (answer["status"] != "match") continue;
      ++(answer["match"].get<std::size_t>() >= 120 ? own : earlier);
    }
  }
  EXPECT_GT(own, 30U);
  EXPECT_GT(earlier, 60U);
  std::size_t edges = 0;
  std::istringstream graph(test::read_all(file("g.g2o")));
  for (std::string line; std::getline(graph, line);) {
    std::istringstream words(line);
    std::string kind;
    std::size_t from = 0;
    std::size_t to = 0;
    words >> kind >> from >> to;
    if (kind != "EDGE_SE3:QUAT" || to == from + 1) continue;
    ++edges;
    EXPECT_NEAR(static_cast<double>(to - from), 90.0, 3.0) << line;
  }
  EXPECT_EQ(edges, own);
  EXPECT_NE(outcome.err.find(std::to_string(earlier) + " loops with places of earlier sessions"),
            std::string::npos)
      << outcome.err;
}

TEST_F(LastingMaps, WhatRunRefusesCheckNamesAndRecoverLeavesOut) {
  expect_done("match --query first.npy --map m.seqloop --out m.csv");
  test::set_frame(file("m.seqloop"), 50, 49);
  const std::string localise = "match --query again.npy --out a.csv --read-only --map ";
  expect_refused(localise + "m.seqloop", "place 50 is none that can follow; seqloop map check");
  expect_refused("map check m.seqloop", "cannot follow place 49: its frame is 49, and that of");
  expect_done("map recover m.seqloop whole.seqloop");
  expect_done("map check whole.seqloop");
  expect_done(localise + "whole.seqloop");
  EXPECT_EQ(nlohmann::json::parse(run("map info whole.seqloop --json").out)["places"], 119);
}

TEST_F(LastingMaps, WhatIsRefusedMakesNoMap) {
  for (const std::string words : {"match --query first.npy --out m.csv --ds 300",
                                  "run --source first.npy --out l.jsonl --ds 300",
                                  "run --source first.npy --out l.jsonl --max-places 4000000000"}) {
    const test::Outcome refused = run(words + " --map new.seqloop");
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_EQ(listing().find("seqloop"), std::string::npos) << words << ": " << listing();
  }
}

TEST_F(LastingMaps, WhatGoesFromAFullMapDoesNotDependOnHowSoonItIsSaved) {
  // In between the robot stands, and then it is dark for so long that many places come at once.
  oracle::Vectors way = oracle::drive(3, 3000, 40, 0.2F);
  for (std::size_t at = 100; at + 50 < way.size(); at += 100) {
    std::fill_n(way.begin() + static_cast<std::ptrdiff_t>(at), 4, way[at]);
    std::fill_n(way.begin() + static_cast<std::ptrdiff_t>(at + 4), 36, std::vector<float>(40));
  }
  write("long.npy", way);
  expect_done(
      "run --source long.npy --map small.seqloop --max-places 100 --full-map thin --save-every-s "
      "0.001 --out small.jsonl");
  for (const std::string every_s : {"0.001", "3600"}) {
    const std::string map = "--map of" + every_s + ".seqloop --max-places 600 --full-map thin ";
    for (const std::string drive : {"long", "other"}) {
      expect_done("run --source " + drive + ".npy " + map + "--session " + drive +
                  " --save-every-s " + every_s + " --out of" + every_s + drive + ".jsonl");
    }
    expect_done("map export of" + every_s + ".seqloop --out of" + every_s);
  }
  for (const std::string part : {"places.csv", "links.csv", "session-1.npy", "session-2.npy"}) {
    const std::string soon = test::read_all(file("of0.001/" + part));
    EXPECT_FALSE(soon.empty()) << part;
    EXPECT_EQ(soon, test::read_all(file("of3600/" + part))) << part;
  }
}

TEST_F(LastingMaps, OfADriveThatCannotBeReadNothingStays) {
  write("dark.npy", oracle::Vectors(100, std::vector<float>(40)));
  expect_done("run --source first.npy --map old.seqloop --session one --out l.jsonl");
  const auto before = nlohmann::json::parse(run("map info old.seqloop --json").out)["sessions"];
  for (const std::string map : {"old.seqloop", "new.seqloop"}) {
    expect_refused("run --source dark.npy --save-every-s 0.001 --map " + map, "can be read");
  }
  // A full map that forgets has forgotten nothing for it. At 200 frames a second, much is saved.
  expect_refused(
      "run --source dark.npy --save-every-s 0.001 --map old.seqloop --max-places 120 --full-map "
      "forget-oldest --pace live --fps 200",
      "can be read");
  EXPECT_EQ(nlohmann::json::parse(run("map info old.seqloop --json").out)["sessions"], before);
  EXPECT_FALSE(exists("new.seqloop"));
}

TEST_F(LastingMaps, WhatDoesNotGoTogetherIsSaid) {
  expect_refused("run --source first.npy --map none.seqloop --read-only", "none.seqloop");
  EXPECT_FALSE(exists("none.seqloop"));
  expect_refused("run --source first.npy --read-only", "there is no map");
  expect_refused("run --source first.npy --map m.seqloop --reference other.npy", "two maps");
  expect_refused("run --source first.npy --map m.seqloop --save-every-s 0", "save-every-s");
  expect_refused("run --source first.npy --map m.seqloop --session 'caf\xe9'", "session: its name");
  expect_refused("match --query first.npy --map first.npy --out m.csv", "first.npy");
  expect_done("match --query first.npy --map m.seqloop --session one --out m.csv");
  expect_refused("match --query again.npy --map m.seqloop --session one --out m.csv", "'one'");
  expect_refused("match --query again.npy --map m.seqloop --arithmetic float --out m.csv",
                 "float euclidean");
  expect_refused(
      "run --source again.npy --map m.seqloop --read-only --odometry o.tum --pose-graph g.g2o",
      "leave --reference and --read-only out");
  expect_refused("run --source again.npy --map m.seqloop --max-places 100", "120 places already");
}

}  // namespace
}  // namespace seqloop
