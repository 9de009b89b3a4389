// SPDX-License-Identifier: MIT
#include "evaluation/match_list.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "expect_setup_error.hpp"

namespace seqloop::evaluation {
namespace {

std::vector<Answer> answers(const std::string& text, ThresholdOn on = ThresholdOn::uniqueness) {
  return parse_answers(text, "r.jsonl", on);
}

void expect_answers(const std::vector<Answer>& found, const std::vector<Answer>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(found[i].query, wanted[i].query);
    EXPECT_EQ(found[i].match, wanted[i].match);
    EXPECT_TRUE(found[i].uncertainty == wanted[i].uncertainty ||
                (std::isnan(found[i].uncertainty) && std::isnan(wanted[i].uncertainty)));
  }
}

TEST(MatchList, TablesAndLinesSayTheSame) {
  const std::string table = "query,match,score,uniqueness\n5,70,0.25,0.5\n6,71,0.125,nan\n";
  const std::string lines =
      R"({"frame":null,"newest":0,"status":"warming_up","match":null,"score":null,"uniqueness":null}
{"frame":4,"newest":9,"status":"no_candidate","match":null,"score":null,"uniqueness":null}
{"frame":5,"newest":10,"status":"match","match":70,"score":0.25,"uniqueness":0.5}

{"frame":6,"newest":11,"status":"not_unique","match":71,"score":0.125,"uniqueness":null}
)";
  const double nan = std::nan("");
  for (const std::string& text : {table, lines, "\r\n " + lines}) {
    expect_answers(answers(text), {{5, 70, 0.5}, {6, 71, nan}});
    expect_answers(answers(text, ThresholdOn::score), {{5, 70, 0.25}, {6, 71, 0.125}});
  }
}

TEST(MatchList, SeveralAnswersOfALineStandForTheLine) {
  const std::string none = R"({"frame":2,"status":"no_candidate","match":null,"uniqueness":null})";
  const std::string third = R"({"frame":3,"match":8,"uniqueness":0.25})";
  const std::string fourth = R"({"frame":4,"match":9,"uniqueness":0.5})";
  const std::string last = R"("frame":4,"match":9,"uniqueness":0.5)";  // as the line itself says it
  expect_answers(answers("{\"frame\":null,\"match\":null,\"uniqueness\":null,\"answers\":[]}\n{" +
                         last + ",\"answers\":[" + none + "," + third + "," + fourth + "]}\n"),
                 {{3, 8, 0.25}, {4, 9, 0.5}});
}

TEST(MatchList, BothSayHowProbableAnAnswerIsAndWhetherItIsAccepted) {
  const std::string table =
      "query,match,score,uniqueness,probability,accepted\n"
      "5,70,0.25,0.5,0.75,1\n6,71,0.5,nan,nan,0\n7,72,0.5,0.5,1,0\n";
  const std::string lines = R"({"answers":[
{"frame":5,"status":"match","match":70,"uniqueness":0.5,"probability":0.75},
{"frame":6,"status":"not_unique","match":71,"uniqueness":null,"probability":null},
{"frame":7,"status":"unsure","match":72,"uniqueness":0.5,"probability":1}]})";
  std::string line = lines;
  std::erase(line, '\n');
  for (const std::string& text : {table, line}) {
    const std::vector<Answer> found = answers(text, ThresholdOn::probability);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].probability, 0.75);
    EXPECT_EQ(found[0].accepted, true);
    EXPECT_TRUE(std::isnan(found[1].probability));
    EXPECT_EQ(found[1].accepted, false);
    EXPECT_LT(found[2].uncertainty, found[0].uncertainty) << "a larger probability is more certain";
    EXPECT_EQ(found[2].accepted, false);
  }
  const std::vector<Answer> without = answers("query,match,score,uniqueness\n1,2,0.5,0.9\n");
  EXPECT_TRUE(std::isnan(without.at(0).probability));
  EXPECT_FALSE(without[0].accepted.has_value());
}

TEST(MatchList, WhatIsWrongIsSaidWithItsLine) {
  const auto refused = [](const std::string& text) {
    return test::setup_error([&] { (void)answers(text); });
  };
  const std::string good = "{\"frame\":1,\"match\":2,\"uniqueness\":0.5}\n";
  EXPECT_TRUE(test::says(refused(good + good), "r.jsonl:2: query 1 is answered twice"));
  EXPECT_TRUE(test::says(refused(good + "{\"frame\":"), "r.jsonl:2: is no JSON object"));
  EXPECT_TRUE(test::says(refused(good + "\n[]\n"), "r.jsonl:3: is no JSON object"));
  EXPECT_TRUE(test::says(refused("{\"frame\":1,\"match\":2}"), "r.jsonl:1: no 'uniqueness'"));
  EXPECT_TRUE(test::says(refused("{\"places\":1}"), "no 'frame': is this what `run` wrote?"));
  EXPECT_TRUE(test::says(refused("{\"frame\":1,\"match\":-2,\"uniqueness\":0.5}"),
                         "'match' is no whole number"));
  EXPECT_TRUE(test::says(refused("{\"frame\":1.5,\"match\":2,\"uniqueness\":0.5}"),
                         "'frame' is no whole number"));
  EXPECT_TRUE(test::says(refused("{\"frame\":18446744073709551615,\"match\":2,\"uniqueness\":0}"),
                         "'frame' is no whole number"));
  EXPECT_TRUE(test::says(refused("{\"frame\":1,\"match\":2,\"uniqueness\":\"low\"}"),
                         "'uniqueness' is no number"));
  EXPECT_TRUE(test::says(refused("{\"frame\":1,\"match\":2,\"uniqueness\":0,\"probability\":1.5}"),
                         "'probability' is not from 0 to 1"));
  EXPECT_EQ(
      answers(good + R"({"frame":null,"match":null,"uniqueness":null,"status":"ended"})").size(),
      1U)
      << "no answer";
  for (const std::string status : {"\"accepted\"", "\"\"", "1", "null"}) {
    const std::string line = R"({"frame":1,"match":2,"uniqueness":0,"status":)" + status + "}";
    EXPECT_TRUE(test::says(refused(line), "'status' is none that `run` writes")) << status;
  }
  EXPECT_TRUE(test::says(refused("{\"answers\":3}"), "'answers' is no array"));
  EXPECT_TRUE(test::says(refused("{\"answers\":[3]}"), "'answers' holds what is no JSON object"));
  EXPECT_TRUE(test::says(refused(""), "empty"));
}

TEST(MatchList, AllBadValuesOfALineAreToldAtOnce) {
  const std::string said = test::setup_error([] {
    (void)answers(R"({"answers":[{"frame":"x","match":-1,"probability":2},3]})"
                  "\n");
  });
  for (const std::string what :
       {"'frame' is no whole number", "'match' is no whole number", "no 'uniqueness'",
        "'probability' is not from 0 to 1", "'answers' holds what is no JSON object"}) {
    EXPECT_TRUE(test::says(said, "r.jsonl:1: " + what));
  }
}

TEST(MatchList, AllBadCellsOfARowAreToldAtOnce) {
  const std::string said = test::setup_error([] {
    (void)answers("query,match,uniqueness,probability,accepted\nx,-1,high,2,yes\nx,-1,high,?,1\n");
  });
  EXPECT_EQ(said,
            "r.jsonl:2: 'x' under 'query' is not a whole number up to 2^62\n"
            "r.jsonl:2: '-1' under 'match' is not a whole number up to 2^62\n"
            "r.jsonl:2: 'high' under 'uniqueness' is not a number\n"
            "r.jsonl:2: '2' under 'probability' is not a number from 0 to 1\n"
            "r.jsonl:2: 'yes' under 'accepted' is not 0 or 1\n"
            "r.jsonl: and 4 more like these");
}

}  // namespace
}  // namespace seqloop::evaluation
