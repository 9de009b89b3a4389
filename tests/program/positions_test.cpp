// SPDX-License-Identifier: MIT
// Truth by where frames were, through the real binary.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "program/program.hpp"

namespace seqloop {
namespace {

class EvalByPositions : public test::Program {
 protected:
  void SetUp() override {
    folder_.write("m.csv",
                  "query,match,score,uniqueness\n0,0,.5,.1\n1,5,.5,.2\n2,2,.5,.3\n3,3,.5,.4\n");
    folder_.write("r.csv", "frame,x,y\n0,0,0\n1,10,0\n2,20,0\n3,30,0\n5,13,9\n");
    folder_.write("q.csv", "frame,x,y\n0,1,0\n1,13,1\n2,29,0\n3,30,-8\n4,31,0\n9,500,0\n");
  }

  void expect_refused(const std::string& arguments, const std::vector<std::string>& words) const {
    SCOPED_TRACE(arguments);
    const test::Outcome outcome = run("eval --matches m.csv " + arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
  }

  const std::string both_ = "--reference-positions r.csv --query-positions q.csv ";
};

TEST_F(EvalByPositions, CountsWhatLiesWithinTheRadius) {
  const auto outcome = run("eval --json --matches m.csv --radius 8 " + both_);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["frames"], 5) << "query 9 is far from all";
  EXPECT_EQ(json["answered"], 4);
  EXPECT_EQ(json["correct"], 3) << "frame 2 is 9 m off; one frame of tolerance would let it pass";
  EXPECT_DOUBLE_EQ(json["recall"], 0.6);
  EXPECT_DOUBLE_EQ(json["recall_at_100_precision"], 0.4);
  const auto words = run("eval --matches m.csv --radius 9 " + both_);
  EXPECT_NE(words.out.find("4 of them right (within 9 metres)"), std::string::npos) << words.out;
  const auto wide = nlohmann::json::parse(run("eval --json --matches m.csv " + both_).out);
  EXPECT_EQ(wide["correct"], 4) << "25 m where no radius is given";
}

// As of a receiver that is slower than the camera.
TEST_F(EvalByPositions, SaysWhichPlacesHaveNone) {
  folder_.write("r.csv", "frame,x,y\n0,0,0\n2,20,0\n3,30,0\n");
  const auto wrong = run("eval --json --matches m.csv --radius 9 " + both_);
  EXPECT_NE(wrong.err.find("1 of 4 answers name a place that has no position, and count as wrong"),
            std::string::npos)
      << wrong.err;
  EXPECT_EQ(nlohmann::json::parse(wrong.out)["answered"], 4);
  const auto unknown = run("eval --json --matches m.csv --radius 9 --unlisted unknown " + both_);
  EXPECT_EQ(unknown.err, "");
  const auto json = nlohmann::json::parse(unknown.out);
  EXPECT_EQ(json["answered"], 3);
  EXPECT_EQ(json["unknown"], 1);
  EXPECT_EQ(json["correct"], 3);
}

TEST_F(EvalByPositions, OneRowsToleranceThroughTheFlags) {
  folder_.write("t.csv", "query,reference,tolerance\n0,1,1\n1,4,0\n2,4,9\n");
  const auto json =
      nlohmann::json::parse(run("eval --json --matches m.csv --truth t.csv --tolerance 5").out);
  EXPECT_EQ(json["correct"], 2);
  const auto words = run("eval --matches m.csv --truth t.csv");
  EXPECT_NE(words.out.find("2 of them right (within the truth's own tolerances)"),
            std::string::npos)
      << words.out;
  folder_.write("t.csv", "query,reference\n0,1\n1,4\n2,4\n");
  const auto asked = run("eval --matches m.csv --truth t.csv --tolerance 1");
  EXPECT_NE(asked.out.find("2 of them right (within 1 frame)"), std::string::npos) << asked.out;
}

TEST_F(EvalByPositions, OfOneDriveTheFirstLapIsNoLoop) {
  std::string laps = "frame,x,y\n";
  std::string matches = "query,match,score,uniqueness\n";
  for (int i = 0; i < 40; ++i) laps += fmt::format("{},{},0\n", i, i % 20);
  for (int i = 20; i < 40; ++i) matches += fmt::format("{},{},.5,.1\n", i, i - 20);
  folder_.write("laps.csv", laps);
  folder_.write("m.csv", matches);
  const auto outcome = run("eval --json --matches m.csv --radius 3 --query-positions laps.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["frames"], 20);
  EXPECT_EQ(json["correct"], 20);
  EXPECT_EQ(json["recall"], 1.0);
  expect_refused("--radius 3 --reference-positions laps.csv --query-positions ./laps.csv",
                 {"every frame is near itself", "leave --reference-positions out"});
}

TEST_F(EvalByPositions, EveryFaultAtOnce) {
  expect_refused("--reference-positions none.csv --query-positions none2.csv --radius 0 --truth t",
                 {"none.csv", "none2.csv", "radius", "truth: positions are given too", "t: "});
  expect_refused("--reference-positions r.csv", {"query-positions: not given"});
  expect_refused("--query-positions q.csv --radius 0", {"above 0"});
  expect_refused("--truth identity " + both_, {"leave one of them out"});
  expect_refused("--radius 3", {"radius", "--reference-positions"});
  expect_refused("--tolerance 2 " + both_, {"tolerance: it counts frames"});
  expect_refused("--jobs 2", {"jobs: it goes with an experiment"});
  expect_refused("--radius -3 " + both_, {"above 0"});
  expect_refused("--radius nan " + both_, {"'nan'"});
  expect_refused("--radius 0.001 " + both_, {"no query frame"});
  expect_refused("--frames 2 " + both_, {"frames: 2", "5"});
  folder_.write("r.csv", "frame,latitude,longitude\n0,0,0\n");
  expect_refused(both_, {"give both alike"});
  folder_.write("r.csv", "frame,x,y\n0,0,0\n0,1,1\n");
  folder_.write("q.csv", "frame,x,y\n0,nan,0\n");
  expect_refused(both_, {"r.csv:3: frame 0 is given twice", "q.csv:2: 'nan'"});
}

}  // namespace
}  // namespace seqloop
