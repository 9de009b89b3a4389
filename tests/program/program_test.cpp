// SPDX-License-Identifier: MIT
// The main job through the real binary, on a drive of synthetic pictures and on synthetic
// descriptors.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "core/oracle.hpp"
#include "evaluation/csv.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

class Run : public test::Program {
 protected:
  void write_npy(const std::string& name, const oracle::Vectors& rows) const {
    files::NpyWriter writer(file(name), rows.front().size());
    for (const auto& row : rows) writer.append(row);
    writer.commit();
  }

  [[nodiscard]] std::vector<nlohmann::json> lines(const std::string& name) const {
    std::istringstream text(test::read_all(file(name)));
    std::vector<nlohmann::json> all;
    for (std::string line; std::getline(text, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }

  /// A file that holds one JSON object.
  [[nodiscard]] nlohmann::json json_of(const std::string& name) const {
    return nlohmann::json::parse(test::read_all(file(name)));
  }

  /// The match list in m.csv against the oracle's.
  void expect_list(const std::vector<oracle::Answer>& wanted) const {
    const auto table = evaluation::CsvTable::read(file("m.csv"));
    ASSERT_EQ(table.rows(), wanted.size());
    for (std::size_t row = 0; row < wanted.size(); ++row) {
      const auto whole = [&](const char* name) {
        return static_cast<std::int64_t>(table.whole(row, table.column(name)));
      };
      EXPECT_EQ(whole("query"), wanted[row].query);
      EXPECT_EQ(whole("match"), wanted[row].match);
      EXPECT_EQ(whole("head"), wanted[row].head);
      EXPECT_EQ(whole("k"), wanted[row].k);
      EXPECT_EQ(whole("candidates"), wanted[row].candidates);
      EXPECT_NEAR(table.number(row, table.column("score")), wanted[row].score, 1e-5);
      EXPECT_NEAR(table.number(row, table.column("velocity")), wanted[row].velocity, 1e-8);
      const double uniqueness = table.number(row, table.column("uniqueness"));
      if (std::isnan(wanted[row].uniqueness)) {
        EXPECT_TRUE(std::isnan(uniqueness));
      } else {
        EXPECT_NEAR(uniqueness, wanted[row].uniqueness, 1e-5);
      }
    }
  }

  test::Outcome expect_done(const std::string& arguments) const {
    test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << '\n' << outcome.err;
    return outcome;
  }
};

TEST_F(Run, BenchTimesColumnsOfEverySizeAskedFor) {
  const auto rows = nlohmann::json::parse(
      expect_done("bench --only column --n 5,16 --d 20 --rounds 3 --json").out);
  for (const int places : {5, 16}) {
    for (const std::string by : {"read-bandwidth", "read-bandwidth-float", "seqloop-int8-scalar",
                                 "seqloop-sketch-scalar", "seqloop-float"}) {
      EXPECT_EQ(std::ranges::count_if(rows,
                                      [&](const nlohmann::json& row) {
                                        return row["what"] == "column" && row["by"] == by &&
                                               row["n"] == places && row["d"] == 20;
                                      }),
                1)
          << by << ' ' << places;
    }
  }
  EXPECT_EQ(run("bench --only column --n 5,,6").exit_code, 2);
  EXPECT_EQ(run("bench --only step --ds 2001").exit_code, 2);
  EXPECT_EQ(run("bench --only column --n 0").exit_code, 2);
  EXPECT_EQ(run("bench --only lunch").exit_code, 2);
}

TEST_F(Run, BenchTimesEveryPartOfAStepByEveryContender) {
  const std::vector<std::string> methods{"seqloop-int8-exhaustive", "seqloop-int8-o-relocalising",
                                         "seqloop-float-exhaustive"};
  const std::vector<std::pair<std::string, std::vector<std::string>>> right{
      {"step", methods},
      {"loop", {methods[0], methods[1]}},
      {"search", {"seqloop-int8", "seqloop-float", "plain-float"}},
      {"matrix", {"seqloop-int8-with-matches", "seqloop-float-with-matches", "seqloop-float"}}};
  for (const auto& [what, contenders] : right) {
    const nlohmann::json rows = nlohmann::json::parse(
        expect_done("bench --json --n 150 --d 30 --ds 10 --rounds 7 --only " + what).out);
    ASSERT_EQ(rows.size(), contenders.size()) << what;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(rows[i]["what"], what);
      EXPECT_EQ(rows[i]["by"], contenders[i]);
      EXPECT_EQ(rows[i]["n"], 150);
      EXPECT_EQ(rows[i]["ds"], 10);
      EXPECT_EQ(rows[i]["rounds"], 7);
      EXPECT_GT(rows[i]["bytes"], 0);
      EXPECT_GT(rows[i]["p50_us"], 0.0);
      EXPECT_LE(rows[i]["p50_us"], rows[i]["p99_us"]);
      EXPECT_LE(rows[i]["p99_us"], rows[i]["p999_us"]);
      EXPECT_LE(rows[i]["p999_us"], rows[i]["max_us"]);
    }
  }
}

TEST_F(Run, BenchTimesHowFastAMapIsOpened) {
  if (SEQLOOP_MAPS == 0) GTEST_SKIP() << "this build keeps no maps in files";
  const auto rows =
      nlohmann::json::parse(expect_done("bench --only open --n 300 --d 64 --rounds 1 --json").out);
  ASSERT_EQ(rows.size(), 3U);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row["what"], "open");
    EXPECT_GT(row["bytes"], 300 * 64) << row["by"];
    EXPECT_GT(row["p50_us"], 0.0) << row["by"];
  }
}

TEST_F(Run, BenchDrivesARobotThatIsRecognised) {
  // With a long window one step answers many frames.
  for (const std::string drive : {"--n 900 --rounds 400", "--ds 200 --n 400 --rounds 2"}) {
    const std::string said = expect_done("bench --only step --d 64 " + drive).err;
    for (std::size_t at = 0, line = 0; line < 3; ++line) {
      at = said.find(" % of the frames found", at + 1);
      ASSERT_NE(at, std::string::npos) << said;
      const std::size_t begin = said.rfind(' ', at - 1);
      const double found = std::stod(said.substr(begin, at - begin));
      EXPECT_GT(found, 60.0) << said;
      EXPECT_LE(found, 100.0) << said;
    }
  }
}

TEST_F(Run, MatchFollowsThePaperToTheLetter) {
  std::uint32_t seed = 5;
  for (const bool closing : {false, true}) {
    for (const auto& [method, candidates] :
         {std::pair{"seqcnnslam", Candidates::all}, std::pair{"a-seqcnnslam", Candidates::ranges},
          std::pair{"o-seqcnnslam", Candidates::adaptive}}) {
      for (const std::size_t ds : {1U, 2U, 7U, 14U, 40U}) {
        SCOPED_TRACE(std::string(method) + (closing ? ", closing" : "") + ", seed " +
                     std::to_string(++seed));
        const oracle::Vectors reference = oracle::drive(seed, 100 + seed, 20, 0.2F);
        const oracle::Vectors query = oracle::drive(seed, 130, 20, 0.3F);
        write_npy("r.npy", reference);
        write_npy("q.npy", query);
        expect_done(
            "match --paper --query q.npy --out m.csv --k 3 --num 6 --reinit 40 "
            "--initial-k 7 --rwindow 8 --exclude 15 --ds " +
            std::to_string(ds) + (closing ? "" : " --reference r.npy") + " --method " + method);
        MatcherConfig config;
        config.arithmetic = Arithmetic::float32;
        config.relocalising.on = false;
        config.candidates = candidates;
        config.sequence_length = ds;
        config.k = 3;
        config.num = 6;
        config.reinit = 40;
        config.initial_k = 7;
        config.rwindow = 8;
        config.exclude = 15;
        expect_list(oracle::match(closing ? oracle::Vectors{} : reference, query, config));
      }
    }
  }
}

TEST_F(Run, SeqSlamTakesPatchesAsTheyAreAndEnhances) {
  oracle::Vectors reference = oracle::drive(8, 120, 20, 0.2F);
  oracle::Vectors query = oracle::drive(8, 110, 20, 0.3F);
  for (oracle::Vectors* rows : {&reference, &query}) {
    for (auto& row : *rows) {
      for (float& value : row) value = 127.5F + 100.0F * value;
    }
  }
  write_npy("r.npy", reference);
  write_npy("q.npy", query);
  MatcherConfig config;
  config.arithmetic = Arithmetic::float32;
  config.candidates = Candidates::all;
  config.difference = Difference::mean_absolute;
  for (const bool enhance : {true, false}) {
    for (const bool closing : {false, true}) {
      config.enhance = enhance;
      config.exclude = 20;
      expect_done(std::string("match --method seqslam --decide-by uniqueness --exclude 20 ") +
                  "--query q.npy --out m.csv" + (enhance ? "" : " --enhance off") +
                  (closing ? "" : " --reference r.npy"));
      expect_list(oracle::match(closing ? oracle::Vectors{} : reference, query, config));
    }
  }
}

TEST_F(Run, SingleImagesAreASequenceOfNone) {
  const oracle::Vectors reference = oracle::drive(8, 60, 20, 0.2F);
  const oracle::Vectors query = oracle::drive(8, 50, 20, 0.3F);
  write_npy("r.npy", reference);
  write_npy("q.npy", query);
  for (const bool enhance : {false, true}) {
    MatcherConfig config;
    config.arithmetic = Arithmetic::float32;
    config.candidates = Candidates::all;
    config.sequence_length = 0;
    config.enhance = enhance;
    expect_done(std::string("match --paper --method single --reference r.npy --query q.npy ") +
                "--out m.csv --enhance " + (enhance ? "on" : "off"));
    const auto wanted = oracle::match(reference, query, config);
    const auto table = evaluation::CsvTable::read(file("m.csv"));
    ASSERT_EQ(wanted.size(), 50U);
    ASSERT_EQ(table.rows(), 50U) << "every frame has an answer";
    for (std::size_t row = 0; row < wanted.size(); ++row) {
      EXPECT_EQ(static_cast<std::int64_t>(table.whole(row, 1)), wanted[row].match);
      EXPECT_NEAR(table.number(row, table.column("uniqueness")), wanted[row].uniqueness, 1e-5);
    }
  }
}

TEST_F(Run, RunAndMatchTreatRowsThatAreNotUnitAlike) {
  oracle::Vectors query = oracle::drive(5, 80, 20, 0.3F);
  for (std::size_t row = 0; row < query.size(); ++row) {
    for (float& value : query[row]) value *= 0.2F + static_cast<float>(row % 7);
  }
  write_npy("q.npy", query);
  write_npy("r.npy", oracle::drive(5, 90, 20, 0.2F));
  expect_done("match --paper --method seqcnnslam --reference r.npy --query q.npy --out m.csv");
  expect_done("run --paper --method seqcnnslam --reference r.npy --source q.npy --out r.jsonl");
  const auto table = evaluation::CsvTable::read(file("m.csv"));
  std::size_t row = 0;
  for (const auto& line : lines("r.jsonl")) {
    if (line["match"].is_null()) continue;
    EXPECT_NEAR(line["score"].get<double>(), table.number(row++, 2), 1e-8);
  }
  EXPECT_EQ(row, table.rows());
  EXPECT_EQ(row, 60U);
}

TEST_F(Run, TheSameInputGivesTheSameBytes) {
  oracle::Vectors laps = oracle::drive(6, 150, 20, 0.2F);
  const oracle::Vectors second = oracle::drive(6, 150, 20, 0.3F);
  laps.insert(laps.end(), second.begin(), second.end());
  write_npy("q.npy", laps);
  for (const std::string method : {"seqcnnslam", "a-seqcnnslam", "o-seqcnnslam"}) {
    expect_done("match --query q.npy --out one.csv --method " + method);
    expect_done("match --query q.npy --out two.csv --method " + method);
    EXPECT_EQ(test::read_all(file("one.csv")), test::read_all(file("two.csv")));
    EXPECT_GT(test::read_all(file("one.csv")).size(), 1000U);
  }
}

TEST_F(Run, ConfigurationFileIsWonOverByFlags) {
  write_npy("q.npy", oracle::drive(6, 80, 20));
  folder_.write("c.toml",
                "method = \"seqcnnslam\"\nds = 10\nexclude = 20\nmax-places = 7\n"
                "standardise = false\n[budget]\ntotal = 1.5\n");
  expect_done("match --config c.toml --query q.npy --out file.csv");
  expect_done(
      "match --method seqcnnslam --ds 10 --exclude 20 --standardise off --query q.npy "
      "--out flags.csv");
  EXPECT_EQ(test::read_all(file("file.csv")), test::read_all(file("flags.csv")));
  expect_done("match --config c.toml --ds 12 --query q.npy --out won.csv");
  folder_.write("paper.toml", "paper = true\nds = 10\nexclude = 20\n");
  expect_done("match --ds 10 --exclude 20 --query q.npy --out plain.csv");
  expect_done("match --config paper.toml --query q.npy --out paper.csv");
  EXPECT_NE(test::read_all(file("paper.csv")), test::read_all(file("plain.csv")));
  expect_done("match --config paper.toml --paper=false --query q.npy --out taken-back.csv");
  EXPECT_EQ(test::read_all(file("taken-back.csv")), test::read_all(file("plain.csv")));
  EXPECT_NE(test::read_all(file("file.csv")), test::read_all(file("won.csv")));
}

TEST_F(Run, SaysThatRowsWereBroughtToUnitLength) {
  oracle::Vectors query = oracle::drive(6, 60, 20);
  write_npy("unit.npy", query);
  for (float& value : query[3]) value *= 7.0F;
  write_npy("long.npy", query);
  expect_done(
      "match --paper --method seqcnnslam --reference unit.npy --query unit.npy --out 1.csv");
  const auto outcome = expect_done(
      "match --paper --method seqcnnslam --reference unit.npy --query long.npy --out 2.csv");
  EXPECT_NE(outcome.err.find("1 of 60 rows"), std::string::npos) << outcome.err;
}

TEST_F(Run, SaysThatADriveHasNothingToRecogniseAPlaceBy) {
  const oracle::Vectors drive = oracle::drive(5, 60, 20);
  oracle::Vectors half = drive;
  std::fill(half.begin() + 30, half.end(), std::vector<float>(20, 0.0F));
  write_npy("good.npy", drive);
  write_npy("half.npy", half);
  write_npy("black.npy", oracle::Vectors(60, std::vector<float>(20, 0.0F)));
  const std::string methods = " --method seqcnnslam --ds 10 --out out";
  for (const std::string verb : {"match --query ", "run --paper --source "}) {
    const std::string black = expect_done(verb + "black.npy --reference good.npy" + methods).err;
    EXPECT_NE(black.find("black.npy: all frames are blank"), std::string::npos) << black;
    const std::string map = expect_done(verb + "good.npy --reference black.npy" + methods).err;
    EXPECT_NE(map.find("black.npy: all frames are blank"), std::string::npos) << map;
    const std::string some = expect_done(verb + "half.npy --reference half.npy" + methods).err;
    const std::size_t first = some.find("half.npy: 30 of 60 frames are blank");
    EXPECT_NE(first, std::string::npos) << some;
    EXPECT_NE(some.find("half.npy: 30 of 60 frames are blank", first + 1), std::string::npos);
    const std::string good = expect_done(verb + "good.npy --reference good.npy" + methods).err;
    EXPECT_EQ(good.find("blank"), std::string::npos) << good;
  }
}

TEST_F(Run, RunAgreesWithMatchAndCountsItsFrames) {
  write_npy("r.npy", oracle::drive(5, 130, 20, 0.2F));
  write_npy("q.npy", oracle::drive(5, 110, 20, 0.3F));
  const std::string by = " --decide-by uniqueness";
  expect_done("match --method o-seqcnnslam --reference r.npy --query q.npy --out m.csv" + by);
  const auto outcome = expect_done("run --reference r.npy --source q.npy --out r.jsonl" + by);
  EXPECT_NE(outcome.err.find("110 frames:"), std::string::npos) << outcome.err;
  for (const char* word : {"p50", "p99", "max", "grab", "describe", "match", "total", "dropped"}) {
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
  }
  const auto table = evaluation::CsvTable::read(file("m.csv"));
  const auto all = lines("r.jsonl");
  ASSERT_EQ(all.size(), 110U);
  std::size_t row = 0;
  for (const auto& line : all) {
    for (const char* key : {"frame", "time_s", "status", "match", "score", "uniqueness", "velocity",
                            "head", "k", "candidates", "distances", "deadline_missed", "dropped"}) {
      EXPECT_TRUE(line.contains(key)) << key;
    }
    for (const char* stage : {"grab", "describe", "match", "total"}) {
      EXPECT_GE(line["latency_ms"][stage].get<double>(), 0.0);
    }
    if (line["match"].is_null()) continue;
    EXPECT_EQ(line["frame"], table.whole(row, 0));
    EXPECT_EQ(line["match"], table.whole(row, 1));
    EXPECT_NEAR(line["score"].get<double>(), table.number(row, 2), 1e-8);
    EXPECT_EQ(line["distances"], table.whole(row, 8));
    EXPECT_TRUE(line["probability"].is_null());
    EXPECT_TRUE(line["now"].is_null());
    EXPECT_EQ(line["answers"].size(), 1U);
    EXPECT_EQ(line["status"] == "match", table.flag(row, table.column("accepted")));
    EXPECT_TRUE(std::isnan(table.number(row, table.column("probability"))));
    ++row;
  }
  EXPECT_EQ(row, table.rows());
  EXPECT_EQ(row, 90U);
}

TEST_F(Run, EveryFrameHasOneFinalAnswer) {
  write_npy("r.npy", oracle::drive(5, 130, 20, 0.2F));
  write_npy("q.npy", oracle::drive(5, 110, 20, 0.3F));
  for (const std::string flags : {"", " --patience 0", " --patience 1000", " --frames 47",
                                  " --method seqcnnslam", " --method single", " --ds 60"}) {
    SCOPED_TRACE(flags);
    const auto outcome =
        expect_done("run --reference r.npy --source q.npy --out r.jsonl --summary s.json" + flags);
    const std::size_t frames = flags == " --frames 47" ? 47 : 110;
    const auto all = lines("r.jsonl");
    ASSERT_EQ(all.size(), frames) << "a line is a frame, whatever waited at the end";
    std::vector<nlohmann::json> answers(frames);
    std::map<std::string, std::size_t> gates;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const nlohmann::json& line = all[i];
      EXPECT_EQ(line["newest"], i);
      for (const char* key : {"place", "probability", "new_place"}) {
        if (!line["now"].is_null()) {
          EXPECT_TRUE(line["now"].contains(key)) << key;
        }
      }
      if (line["answers"].empty()) {
        EXPECT_TRUE(line["status"] == "warming_up" || line["status"] == "waiting");
        for (const char* key : {"frame", "match", "probability"}) EXPECT_TRUE(line[key].is_null());
        continue;
      }
      for (const auto& [key, value] : line["answers"].back().items()) {
        EXPECT_EQ(line[key], value) << "the last one stands beside the others";
      }
      std::size_t before = 0;
      for (const nlohmann::json& answer : line["answers"]) {
        const auto frame = answer["frame"].get<std::size_t>();
        ASSERT_LE(frame, i);
        EXPECT_GE(frame, before) << "in order";
        EXPECT_TRUE(answers[frame].is_null()) << "once";
        answers[frame] = answer;
        before = frame;
        ++gates[answer["status"]];
        EXPECT_EQ(answer.size(), 8U);
        const auto probability = answer["probability"].get<double>();
        EXPECT_EQ(answer["status"] == "match", probability >= 0.99 && !answer["match"].is_null());
      }
    }
    EXPECT_EQ(std::ranges::count(answers, nlohmann::json()), 0);
    const nlohmann::json summary = json_of("s.json");
    for (const auto& [gate, count] : summary["gates"].items()) {
      EXPECT_EQ(count, gates[gate]) << gate;
    }
    EXPECT_GT(gates["match"], 20U) << outcome.err;
    EXPECT_NE(outcome.err.find(std::to_string(gates["match"]) + " match"), std::string::npos);
    if (flags == " --frames 47") continue;

    // The match list says the same.
    expect_done("match --reference r.npy --query q.npy --out m.csv" + flags);
    const auto table = evaluation::CsvTable::read(file("m.csv"));
    std::size_t row = 0;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const nlohmann::json& answer = answers[frame];
      if (answer["match"].is_null()) continue;
      ASSERT_LT(row, table.rows());
      EXPECT_EQ(table.whole(row, table.column("query")), frame);
      EXPECT_EQ(table.whole(row, table.column("match")), answer["match"]);
      EXPECT_EQ(table.whole(row, table.column("head")), answer["head"]);
      EXPECT_NEAR(table.number(row, table.column("probability")),
                  answer["probability"].get<double>(), 1e-8);
      EXPECT_EQ(table.flag(row, table.column("accepted")), answer["status"] == "match");
      ++row;
    }
    EXPECT_EQ(row, table.rows());
  }
}

TEST_F(Run, TheMatchListAcceptsByWhatDecides) {
  write_npy("r.npy", oracle::drive(5, 130, 20, 0.2F));
  write_npy("q.npy", oracle::drive(5, 110, 20, 0.3F));
  const auto list = [&](const std::string& flags) {
    expect_done("match --reference r.npy --query q.npy --out m.csv " + flags);
    EXPECT_TRUE(test::read_all(file("m.csv"))
                    .starts_with("query,match,score,uniqueness,velocity,head,candidates,k,"
                                 "distances,probability,accepted\n"));
    return evaluation::CsvTable::read(file("m.csv"));
  };
  for (const std::string flags :
       {"--paper", "--decide-by uniqueness", "--paper --max-uniqueness 0.8"}) {
    const auto table = list(flags);
    const double most = flags.ends_with("0.8") ? 0.8 : 0.94;
    EXPECT_EQ(table.rows(), 90U) << "the window's half on either side has no answer";
    for (std::size_t row = 0; row < table.rows(); ++row) {
      EXPECT_TRUE(std::isnan(table.number(row, table.column("probability"))));
      EXPECT_EQ(table.flag(row, table.column("accepted")),
                table.number(row, table.column("uniqueness")) <= most);
    }
  }
  std::size_t before = 111;
  for (const std::string least : {"1e-9", "0.5", "0.99", "1"}) {
    const auto table = list("--min-probability " + least);
    EXPECT_GT(table.rows(), 90U) << "edges have answers";
    std::size_t accepted = 0;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const bool sure = table.number(row, table.column("probability")) >= std::stod(least);
      EXPECT_EQ(table.flag(row, table.column("accepted")), sure) << least;
      accepted += sure;
    }
    EXPECT_LE(accepted, before) << "the more sure, no more of them";
    before = accepted;
  }
  EXPECT_LT(before, 111U);
  const auto by_default = test::read_all(file("m.csv"));
  list("--paper --decide-by probability");
  EXPECT_NE(by_default, test::read_all(file("m.csv")));
}

TEST_F(Run, PlacesOfAMapThatForgetsAreNamedAlikeByRunAndMatch) {
  oracle::Vectors laps = oracle::drive(6, 150, 20, 0.2F);
  for (int lap = 0; lap < 3; ++lap) {
    const oracle::Vectors more = oracle::drive(6, 150, 20, 0.3F);
    laps.insert(laps.end(), more.begin(), more.end());
  }
  write_npy("q.npy", laps);
  for (const std::string full_map : {"forget-oldest", "thin"}) {
    expect_done(
        "run --source q.npy --max-places 200 --out r.jsonl --decide-by uniqueness "
        "--full-map " +
        full_map);
    std::size_t beyond = 0;
    for (const auto& line : lines("r.jsonl")) {
      if (line["match"].is_null()) continue;
      EXPECT_LT(line["match"], line["frame"]);
      beyond += line["match"] > 200 ? 1U : 0U;
    }
    EXPECT_GT(beyond, 50U) << "numbers go on where the room ends";
  }
}

TEST_F(Run, StreamsToStandardOutputWhenNoFileIsNamed) {
  write_npy("q.npy", oracle::drive(5, 60, 20));
  const auto outcome = expect_done("run --source q.npy --ds 10 --exclude 20 | cat");
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 60);
}

// Whoever copies the program to a board may forget what reads pictures.
TEST_F(Run, ACopyWithoutItsModuleSaysSoOnceAndBeforeTheDrive) {
  std::filesystem::copy_file(SEQLOOP_BINARY, file("copy"));
  write_npy("q.npy", oracle::drive(5, 60, 20));
  std::filesystem::create_directory(file("drive"));
  for (const char* name : {"drive/1.png", "drive/2.png"}) std::ofstream(file(name)) << "no picture";
  for (const char* arguments :
       {"--source drive", "--source q.npy --pictures drawn", "--source drive --pictures drawn"}) {
    SCOPED_TRACE(arguments);
    const auto outcome =
        run("--version; ./copy run --ds 10 --exclude 20 --out l.jsonl " + std::string(arguments));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.err.find("seqloop: seqloop-codecs.so: is not there"), 0U) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(exists("l.jsonl"));
    EXPECT_FALSE(exists("drawn"));
  }
}

// A robot that stands adds no place, but places are called by their frames.
TEST_F(Run, TheMatrixNamesPlacesAsTheAnswersDo) {
  oracle::Vectors stop = oracle::drive(6, 60, 20);
  stop.insert(stop.end(), 60, stop.back());
  const oracle::Vectors rest = oracle::drive(7, 60, 20);
  stop.insert(stop.end(), rest.begin(), rest.end());
  write_npy("stop.npy", stop);
  const auto highest = [&](const std::string& keyframes) {
    expect_done("run --source stop.npy --exclude 20 --out l.jsonl --pictures drawn --keyframes " +
                keyframes);
    const cv::Mat picture = cv::imread(file("drawn/difference_matrix.png"));
    return picture(cv::Rect(0, 20, 66, 30)).clone();  // beside the upper end of the axis
  };
  EXPECT_EQ(cv::norm(highest("on"), highest("off"), cv::NORM_INF), 0.0);
}

TEST_F(Run, EachOutputThatCanBeWrittenIs) {
  oracle::Vectors laps = oracle::drive(6, 150, 20, 0.2F);
  const oracle::Vectors second = oracle::drive(6, 150, 20, 0.3F);
  laps.insert(laps.end(), second.begin(), second.end());
  write_npy("laps.npy", laps);
  folder_.write("o.tum", "0 0 0 0 0 0 0 1\n300 300 0 0 0 0 0 1\n");
  std::filesystem::create_directories(file("drawn"));
  std::filesystem::create_symlink("nowhere/at.png", file("drawn/difference_matrix.png"));
  const std::string others =
      "run --source laps.npy --fps 1 --odometry o.tum --pose-graph g.g2o --trajectory t.tum "
      "--out-bag b.mcap --pictures drawn ";
  const test::Outcome outcome = run(others + "--out l.jsonl --summary /dev/full");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  for (const char* words : {"/dev/full: cannot be ", "difference_matrix.png: is a link"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(lines("l.jsonl").size(), 300U);
  for (const char* name : {"b.mcap", "g.g2o", "t.tum"}) {
    EXPECT_TRUE(std::filesystem::remove(file(name))) << name;
  }
  // Without its lines the run ends at once: what there is of the others would replace whole ones.
  EXPECT_EQ(run(others + "--out /dev/full").exit_code, 1);
  for (const char* name : {"b.mcap", "g.g2o", "t.tum"}) EXPECT_FALSE(exists(name)) << name;
}

TEST_F(Run, WhatIsKeptOfLinesThatTheDiskDoesNotTakeIsWhole) {
  write_npy("drive.npy", oracle::drive(6, 300, 20, 0.2F));
  const test::Outcome outcome = run("--version >/dev/null; ulimit -f 100; '" SEQLOOP_BINARY
                                    "' run --source drive.npy --out l.jsonl");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_FALSE(exists("l.jsonl"));
  const std::string kept = test::read_all(file("l.jsonl.incomplete"));
  EXPECT_GT(kept.size(), 40'000U);
  EXPECT_EQ(kept.back(), '\n') << kept.substr(kept.size() - 100);
  EXPECT_EQ(run("report l.jsonl.incomplete --out page.html").exit_code, 0);
}

TEST_F(Run, PicturesOfWhichOneIsAFolderAreRefusedBeforeAnyWork) {
  write_npy("drive.npy", oracle::drive(6, 150, 20, 0.2F));
  std::filesystem::create_directories(file("drawn/matches.png"));
  const test::Outcome outcome = run("run --source drive.npy --out l.jsonl --pictures drawn");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("drawn/matches.png: is a folder"), std::string::npos) << outcome.err;
  EXPECT_FALSE(exists("l.jsonl"));
}

TEST_F(Run, NeverReplacesWhatALinkOfTheSystemLeadsTo) {
  // As root, renaming over /dev/stdout would take the whole machine's standard output away.
  write_npy("q.npy", oracle::drive(5, 60, 20));
  const std::string run = "run --source q.npy --ds 10 --exclude 20 --out ";
  std::filesystem::create_symlink("/proc/self/fd/1", file("link"));
  for (const std::string out : {"-", "/dev/stdout", "/proc/self/fd/1", "link"}) {
    const auto outcome = expect_done(run + out + " | cat");
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 60) << out;
    expect_done(run + out + " > plain.jsonl");
    const std::string plain = test::read_all(file("plain.jsonl"));
    EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), 60) << out;
  }
  EXPECT_TRUE(std::filesystem::is_symlink(file("link")));
  EXPECT_TRUE(std::filesystem::is_symlink("/dev/stdout"));
}

TEST_F(Run, EvalMeasuresByTheBook) {
  folder_.write("m.csv",
                "query,match,score,uniqueness\n0,0,0.9,0.1\n1,3,0.1,0.2\n2,9,0.5,0.3\n3,3,0.5,0.3\n"
                "4,4,0.7,nan\n");
  const auto json = [&](const std::string& more) {
    return nlohmann::json::parse(expect_done("eval --json --matches m.csv " + more).out);
  };
  const auto by_uniqueness = json("--frames 10");
  EXPECT_EQ(by_uniqueness["answered"], 5);
  EXPECT_EQ(by_uniqueness["correct"], 4);
  EXPECT_NEAR(by_uniqueness["precision"], 0.8, 1e-12);
  EXPECT_NEAR(by_uniqueness["recall"], 0.4, 1e-12);
  EXPECT_NEAR(by_uniqueness["recall_at_100_precision"], 0.2, 1e-12);
  // (.1, 1) (.2, 1) (.3, 3/4) (.4, 4/5): equal thresholds enter together
  EXPECT_NEAR(by_uniqueness["area_under_curve"], 0.2 + 0.1 * 0.875 + 0.1 * 0.775, 1e-12);
  EXPECT_NEAR(json("--frames 10 --threshold-on score")["recall_at_100_precision"], 0.1, 1e-12);
  EXPECT_EQ(json("--tolerance 1")["correct"], 3);
  EXPECT_NEAR(json("")["recall"], 0.8, 1e-12) << "the matches reach to frame 4";
  folder_.write("t.csv", "query,reference\n2,9\n2,100\n4,4\n7,7\n");
  const auto by_file = json("--truth t.csv --tolerance 0");
  EXPECT_EQ(by_file["correct"], 2);
  EXPECT_NEAR(by_file["recall"], 2.0 / 3.0, 1e-12);
  EXPECT_EQ(json("--truth t.csv --unlisted unknown")["answered"], 2);
  EXPECT_EQ(json("--truth t.csv --unlisted unknown")["unknown"], 3);
  EXPECT_EQ(json("--truth no-revisit")["correct"], 0);
  for (const char* key :
       {"expected_calibration_error", "accepted", "accepted_precision", "accepted_recall"}) {
    ASSERT_TRUE(by_file.contains(key)) << key;
    EXPECT_TRUE(by_file[key].is_null()) << "the list does not say: " << key;
  }
}

/// The only point of such a curve would pass for what the method can do.
TEST_F(Run, EvalSaysWhereThereIsNothingToSweep) {
  const auto said = [&](const std::string& rows) {
    folder_.write("m.csv", "query,match,score,uniqueness,probability,accepted\n" + rows);
    return expect_done("eval --json --matches m.csv --frames 2 --threshold-on probability").err;
  };
  EXPECT_NE(said("0,0,0.9,0.1,nan,1\n1,7,0.1,0.2,nan,0\n").find("no answer has a probability"),
            std::string::npos);
  EXPECT_EQ(said("0,0,0.9,0.1,nan,1\n1,7,0.1,0.2,.5,0\n"), "");
  EXPECT_EQ(said(""), "");
}

TEST_F(Run, EvalMeasuresWhatIsAcceptedAndHowSurely) {
  folder_.write("m.csv",
                "query,match,score,uniqueness,probability,accepted\n0,0,0.9,0.1,1,1\n"
                "1,7,0.1,0.2,0.75,0\n2,2,0.5,0.3,0.75,0\n3,3,0.5,0.3,0.995,1\n4,4,.7,nan,nan,0\n");
  const auto json = nlohmann::json::parse(
      expect_done("eval --json --matches m.csv --threshold-on probability").out);
  EXPECT_EQ(json["accepted"], 2);
  EXPECT_EQ(json["accepted_precision"], 1.0);
  EXPECT_NEAR(json["accepted_recall"], 0.4, 1e-12);
  EXPECT_NEAR(json["recall_at_100_precision"], 0.4, 1e-12);
  EXPECT_NEAR(json["expected_calibration_error"], (0.5 + 0.005) / 4.0, 1e-12);
  ASSERT_EQ(json["reliability"].size(), 10U);
  EXPECT_EQ(json["reliability"][7], (nlohmann::json{{"from", 0.7},
                                                    {"to", 0.8},
                                                    {"count", 2},
                                                    {"mean_probability", 0.75},
                                                    {"share_right", 0.5}}));
  EXPECT_TRUE(json["reliability"][0]["share_right"].is_null());
  const std::string words = expect_done("eval --matches m.csv").out;
  EXPECT_NE(words.find("       2 accepted\n   1.000 precision of what is accepted\n"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("   0.126 expected calibration error\n"), std::string::npos) << words;
  EXPECT_NE(words.find("  0.7 to 0.8        2 0.750  0.500\n"), std::string::npos) << words;
}

TEST_F(Run, EvalTakesTheLinesOfARunAndSaysWhatRecallIsOver) {
  write_npy("map.npy", oracle::drive(3, 80, 12));
  write_npy("drive.npy", oracle::drive(4, 60, 12));
  const std::string drives = " map.npy --ds 10 --out ";
  expect_done("match --query drive.npy --reference" + drives + "m.csv");
  expect_done("run --source drive.npy --reference" + drives + "r.jsonl");
  const std::string frames = " --frames 60 --json --matches ";
  const auto measured = [&](const std::string& list, const std::string& more) {
    auto json = nlohmann::json::parse(expect_done("eval" + more + frames + list).out);
    // The last digits of probabilities are written differently.
    auto& error = json["expected_calibration_error"];
    EXPECT_GT(error.get<double>(), 0.0) << list;
    error = std::round(error.get<double>() * 1e6);
    json.erase("reliability");
    return json;
  };
  EXPECT_EQ(measured("r.jsonl", ""), measured("m.csv", ""));
  EXPECT_EQ(measured("r.jsonl", "")["answered"], 60) << "at the ends, too";
  EXPECT_EQ(expect_done("eval" + frames + "r.jsonl").err, "");
  EXPECT_EQ(measured("r.jsonl", " --threshold-on score"),
            measured("m.csv", " --threshold-on score"));
  const auto as_far = expect_done("eval --json --matches r.jsonl");
  EXPECT_EQ(nlohmann::json::parse(as_far.out)["frames"], 60);
  EXPECT_NE(as_far.err.find("recall is over the first 60 frames only"), std::string::npos)
      << as_far.err;
  EXPECT_NE(as_far.err.find("--frames"), std::string::npos);
  folder_.write("t.csv", "query,reference\n20,20\n");
  EXPECT_EQ(expect_done("eval --truth t.csv --json --matches r.jsonl").err, "");
}

TEST_F(Run, MatchHasTheSameDefaultMethodAsRun) {
  write_npy("drive.npy", oracle::drive(3, 80, 12));
  const std::string match = "match --reference drive.npy --query drive.npy --k 3 --num 4 --out ";
  expect_done(match + "default.csv");
  expect_done(match + "o.csv --method o-seqcnnslam");
  expect_done(match + "all.csv --method seqcnnslam");
  EXPECT_EQ(test::read_all(file("default.csv")), test::read_all(file("o.csv")));
  EXPECT_NE(test::read_all(file("default.csv")), test::read_all(file("all.csv")));
  expect_done("run --source drive.npy --reference drive.npy --out r.jsonl --summary s.json");
  EXPECT_EQ(nlohmann::json::parse(test::read_all(file("s.json")))["method"], "o-seqcnnslam");
}

TEST_F(Run, PlanPrintsEveryBufferAndTheMostWork) {
  const auto paper = expect_done("plan --paper --max-places 1000 --descriptor-size 64 --ds 10");
  EXPECT_NE(paper.out.find("256000  map: places"), std::string::npos) << paper.out;
  EXPECT_NE(paper.out.find("11010  descriptor distances"), std::string::npos)
      << "11 columns of 1,000, and 10 for the change degree: " << paper.out;
  EXPECT_NE(paper.out.find("5000  line sums"), std::string::npos) << "velocities 0.8 .. 1.2";
  const auto plan = expect_done("plan --max-places 10000 --descriptor-size 64 --ds 10");
  EXPECT_NE(plan.out.find("640000  map: places"), std::string::npos) << plan.out;
  EXPECT_NE(plan.out.find("285  descriptor distances"), std::string::npos)
      << "256, 10 for the change degree, 19 for how far to the side: " << plan.out;
  EXPECT_NE(plan.out.find("255  line sums"), std::string::npos) << "51 rows, 5 velocities";
  EXPECT_NE(plan.out.find("3  frames until the whole map"), std::string::npos) << plan.out;
  // However large the map, a fifth of a second of driving, as far as a tenth of the budget goes.
  const auto rounds = [&](const std::string& flags) {
    const std::string out = expect_done("plan --descriptor-size 64 " + flags).out;
    const std::size_t line = out.find("  frames until the whole map");
    return std::stoul(out.substr(out.rfind('\n', line) + 1));
  };
  EXPECT_EQ(rounds("--max-places 20480"), 5U);
  EXPECT_EQ(rounds("--max-places 102400"), 5U);
  EXPECT_EQ(rounds("--max-places 2000000"), 5U);
  EXPECT_EQ(rounds("--max-places 10000000"), 25U);
  EXPECT_EQ(rounds("--max-places 20000000"), 50U);
  EXPECT_EQ(rounds("--max-places 1000000 --relocalise-s 2"), 50U);
  EXPECT_EQ(rounds("--max-places 1000000 --slice 4096"), 245U);
  const auto fleet =
      expect_done("plan --max-places 10000 --descriptor-size 64 --ds 10 --fleet-places 20000");
  for (const char* line : {"1280000  others' map: places", "640000  map: places",
                           "among 20000 places of other robots, in addition"}) {
    EXPECT_NE(fleet.out.find(line), std::string::npos) << line << " in\n" << fleet.out;
  }
  EXPECT_EQ(plan.out.find("others"), std::string::npos) << plan.out;
  EXPECT_EQ(run("plan --fleet-places 2000000").exit_code, 2);
  for (const auto& printed : {paper, plan, fleet}) {
    EXPECT_EQ(printed.out.find("\n               0  "), std::string::npos) << "empty buffers";
  }
}

TEST_F(Run, VersionAndHelpEverywhere) {
  EXPECT_NE(expect_done("--version").out.find("seqloop "), std::string::npos);
  for (const std::string verb : {"run", "describe", "match", "eval", "plan"}) {
    EXPECT_NE(expect_done(verb + " --version").out.find("seqloop "), std::string::npos);
    EXPECT_NE(expect_done(verb + " --help").out.find("--config"), std::string::npos);
  }
}

/// Flags of a help text, each under its heading.
std::map<std::string, std::string> flags_of(const std::string& help) {
  std::map<std::string, std::string> headings;
  std::istringstream text(help);
  std::string heading;
  for (std::string line; std::getline(text, line);) {
    EXPECT_LE(line.size(), 100U) << line;
    if (line.ends_with(':') && !line.starts_with(' ')) heading = line.substr(0, line.size() - 1);
    const std::size_t flag = line.find("--");
    if (flag == 2 || line.starts_with("  -h,")) {
      const std::string name = line.substr(flag, line.find_first_of(" ", flag) - flag);
      EXPECT_TRUE(headings.emplace(name, heading).second) << name << " twice";
    }
  }
  return headings;
}

TEST_F(Run, HelpIsGroupedAndHelpAllHasEveryFlag) {
  const std::string help = expect_done("run --help").out;
  const auto most_used = flags_of(help);
  const auto all = flags_of(expect_done("run --help-all").out);
  const std::map<std::string, std::string> wanted{{"--source", "Task"},
                                                  {"--fps", "Source"},
                                                  {"--model", "Model"},
                                                  {"--ds", "Matching"},
                                                  {"--min-probability", "Decision"},
                                                  {"--budget-total", "Budget"},
                                                  {"--size", "Camera"},
                                                  {"--realtime-cpus", "Real time"},
                                                  {"--config", "General"}};
  for (const auto& [flag, heading] : wanted) {
    ASSERT_TRUE(most_used.contains(flag)) << flag;
    EXPECT_EQ(most_used.at(flag), heading) << flag;
  }
  for (const auto& [flag, heading] : most_used) {
    ASSERT_TRUE(all.contains(flag)) << flag;
    EXPECT_EQ(all.at(flag), heading) << flag;
  }
  EXPECT_FALSE(most_used.contains("--initial-k"));
  EXPECT_EQ(all.at("--initial-k"), "Matching");
  EXPECT_LT(most_used.size(), 40U);
  EXPECT_GT(all.size(), 57U);
  EXPECT_NE(help.find(std::to_string(all.size() - most_used.size()) + " more flags: seqloop run"),
            std::string::npos);
  for (const std::string task : {"close loops", "localise", "time a recording", "as SeqSLAM"})
    EXPECT_NE(help.find("\n  " + task), std::string::npos) << task;
}

}  // namespace
}  // namespace seqloop
