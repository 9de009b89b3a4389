// SPDX-License-Identifier: MIT
#include "evaluation/truth.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "expect_setup_error.hpp"

namespace seqloop::evaluation {
namespace {

Truth from_text(const std::string& text) { return Truth::from_csv(CsvTable(text, "t.csv")); }

Positions positions(const std::string& text) {
  return Positions::from_csv(CsvTable(text, "p.csv"));
}

TEST(Truth, ATolerancesColumnHoldsForItsOwnRow) {
  const Truth truth = from_text("query,tolerance,reference\n4,0,10\n4,5,100\n7,1,3\n");
  EXPECT_EQ(truth.frames(), 2U);
  EXPECT_TRUE(truth.right(4, 10, 2));
  EXPECT_FALSE(truth.right(4, 11, 2));
  EXPECT_TRUE(truth.right(4, 95, 2));
  EXPECT_TRUE(truth.right(4, 105, 0));
  EXPECT_FALSE(truth.right(4, 106, 50));
  EXPECT_TRUE(truth.right(7, 2, 0));
  EXPECT_FALSE(truth.right(8, 3, 9));
}

TEST(Truth, WithoutTheColumnTheAskedToleranceHolds) {
  const Truth truth = from_text("query,reference\n4,10\n");
  EXPECT_TRUE(truth.right(4, 12, 2));
  EXPECT_FALSE(truth.right(4, 13, 2));
  EXPECT_TRUE(truth.right(4, 0, ~std::uint64_t{0})) << "no overflow";
  EXPECT_TRUE(
      test::says(test::setup_error([] { (void)from_text("query,reference,tolerance\n1,2,-1\n"); }),
                 "t.csv:2"));
}

TEST(Truth, AnEmptyToleranceIsNone) {
  const Truth truth = from_text("query,reference,tolerance\n1,10,\n2,20,0\n");
  EXPECT_TRUE(truth.right(1, 12, 2));
  EXPECT_FALSE(truth.right(1, 12, 1));
  EXPECT_FALSE(truth.right(2, 21, 2));
  EXPECT_EQ(truth.own_tolerances(), OwnTolerances::some);
}

std::string faults_of(const std::string& text) {
  return test::setup_error([&] { (void)from_text(text); });
}

TEST(Truth, IsReadAsOthersWriteTables) {
  const Truth truth =
      from_text("\"\",\"query\", \"reference\" \n\"1\",\"4\",10\n\"a \"\"b\"\", c\",5,\"11\"\n");
  EXPECT_TRUE(truth.right(4, 10, 0));
  EXPECT_TRUE(truth.right(5, 11, 0));
  EXPECT_EQ(from_text("query,reference,,\n4,10,,\n").frames(), 1U);
  EXPECT_TRUE(test::says(faults_of("query,reference\n\"4,10\n"), "t.csv:2: a cell in quotes"));
  EXPECT_TRUE(test::says(faults_of("query,reference\n\"4\"5,10\n"), "t.csv:2: a cell in quotes"));
  EXPECT_TRUE(
      test::says(faults_of("\"query\";\"reference\"\n4;10\n"), "separated by ';'; write commas"));
  EXPECT_TRUE(test::says(faults_of("query\treference\n4\t1\n"), "by tabs; write commas"));
}

TEST(Truth, TellsAllThatIsWrongWithAFile) {
  EXPECT_TRUE(test::says(faults_of("query,query,a,a\n1,2,3,4\n"), "'query' is there twice"));
  EXPECT_TRUE(test::says(faults_of("query,query,a,a\n1,2,3,4\n"), "'a' is there twice"));
  EXPECT_TRUE(test::says(faults_of("0,0\n1,1\n"), "t.csv:1: has numbers, and not the names"));
  EXPECT_TRUE(test::says(faults_of("a,b\n1,2\n"), "'query'"));
  EXPECT_TRUE(test::says(faults_of("a,b\n1,2\n"), "'reference'"));
  EXPECT_TRUE(
      test::says(faults_of("query,reference\n"), "t.csv: it has no rows; --truth no-revisit"));
  std::string cells = "query,reference\n";
  std::string lengths = cells;
  for (int line = 2; line <= 9; ++line) {
    cells += "1,x\n";
    lengths += "1\n";
  }
  for (const std::string& text : {cells, lengths}) {
    const std::string said = faults_of(text);
    EXPECT_TRUE(test::says(said, "t.csv:2: "));
    EXPECT_TRUE(test::says(said, "t.csv:6: "));
    EXPECT_FALSE(test::says(said, "t.csv:7: "));
    EXPECT_TRUE(test::says(said, "t.csv: and 3 more like these"));
  }
}

TEST(Truth, TellsAllBadCellsOfARow) {
  const std::string said = faults_of("query,reference,tolerance\nx,y,z\n");
  for (const char* header : {"'x' under 'query'", "'y' under 'reference'", "'z' under 'tolerance'"})
    EXPECT_TRUE(test::says(said, header));
  const std::string placed = test::setup_error([] { (void)positions("frame,x,y\n-1,a,b\n"); });
  for (const char* header : {"'-1' under 'frame'", "'a' under 'x'", "'b' under 'y'"})
    EXPECT_TRUE(test::says(placed, header));
}

TEST(Truth, ByPositionsOnAPlan) {
  const Positions reference = positions("frame,x,y\n0,0,0\n1,3,4\n2,30,0\n10,0,5\n");
  const Positions query = positions("y,x,frame\n0,0,5\n0,100,6\n-1.5,30,7\n");
  const Truth truth = Truth::from_positions(reference, query, 5.0);
  EXPECT_EQ(truth.frames(), 2U) << "query 6 is nowhere near";
  EXPECT_TRUE(truth.right(5, 0, 0));
  EXPECT_TRUE(truth.right(5, 1, 0)) << "exactly 5 m away";
  EXPECT_FALSE(truth.right(5, 2, 9)) << "a tolerance in frames does not apply";
  EXPECT_FALSE(truth.right(5, 9, 9));
  EXPECT_TRUE(truth.right(5, 10, 0));
  EXPECT_FALSE(truth.right(6, 2, 0));
  EXPECT_TRUE(truth.right(7, 2, 0));
  EXPECT_FALSE(truth.right(8, 2, 0));
}

TEST(Truth, WhatIsNotListedCanBeUnknown) {
  const CsvTable table("query,reference\n4,10\n", "t.csv");
  EXPECT_TRUE(Truth::from_csv(table).judges(5, 10));
  const Truth truth = Truth::from_csv(table, Unlisted::unknown);
  EXPECT_TRUE(truth.judges(4, 9));
  EXPECT_FALSE(truth.judges(5, 10));
  // A frame whose position is known, far from all others, is new.
  const Positions here = positions("frame,x,y\n0,0,0\n");
  const Positions there = positions("frame,x,y\n0,0,0\n1,99,0\n");
  const Truth placed = Truth::from_positions(here, there, 5.0, Unlisted::unknown);
  EXPECT_EQ(placed.frames(), 1U);
  EXPECT_TRUE(placed.judges(1, 0));
  EXPECT_FALSE(placed.right(1, 0, 9));
  EXPECT_FALSE(placed.judges(2, 0));
  EXPECT_TRUE(placed.knows(0));
  EXPECT_FALSE(placed.knows(1));
  EXPECT_FALSE(placed.judges(0, 1)) << "nobody knows where that place is";
  EXPECT_TRUE(Truth::from_positions(here, there, 5.0).judges(0, 1)) << "wrong, unless it is asked";
}

TEST(Truth, WithoutARevisitNothingIsRight) {
  const Truth truth = Truth::no_revisit();
  EXPECT_EQ(truth.frames(), 0U);
  EXPECT_TRUE(truth.judges(3, 3));
  EXPECT_FALSE(truth.right(3, 3, 100));
}

TEST(Truth, OfLapsIsTheSameFrameOfAnyLapBefore) {
  const Truth truth = Truth::laps(10, 3);
  EXPECT_EQ(truth.frames(), 20U);
  EXPECT_EQ(truth.queries_reach(), 30U);
  EXPECT_EQ(truth.places_reach(), 20U);
  for (std::uint64_t query = 0; query < 30; ++query) {
    for (std::uint64_t match = 0; match < 30; ++match) {
      const bool before = match < query && (query - match) % 10 == 0;
      EXPECT_EQ(truth.right(query, match, 0), before) << query << ' ' << match;
    }
  }
  EXPECT_TRUE(truth.right(25, 7, 2));
  EXPECT_FALSE(truth.right(25, 8, 2));
  EXPECT_EQ(Truth::laps(10, 1).frames(), 0U);
}

/// The usual formula, which the program does not use.
double haversine(double latitude_a, double longitude_a, double latitude_b, double longitude_b) {
  constexpr double degree = std::numbers::pi / 180.0;
  const double north = std::sin((latitude_b - latitude_a) * degree / 2.0);
  const double east = std::sin((longitude_b - longitude_a) * degree / 2.0);
  const double half =
      north * north + std::cos(latitude_a * degree) * std::cos(latitude_b * degree) * east * east;
  return 2.0 * 6'371'008.8 * std::asin(std::sqrt(half));
}

TEST(Truth, ByPositionsOnEarthAgreesWithHaversines) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> spread(-0.01, 0.01);
  for (const auto& [latitude, longitude] :
       {std::pair{63.4, 10.4}, std::pair{-33.9, 179.999}, std::pair{89.99, 0.0}}) {
    std::vector<std::array<double, 2>> places;
    std::string text = "frame,latitude,longitude\n";
    for (int i = 0; i < 60; ++i) {
      auto east = longitude + 2.0 * spread(random);
      if (east > 180.0) east -= 360.0;
      places.push_back({std::min(latitude + spread(random), 90.0), east});
      text += fmt::format("{},{},{}\n", i, places.back()[0], places.back()[1]);
    }
    const Positions all = positions(text);
    std::size_t near = 0;
    for (const double radius : {50.0, 300.0, 2000.0}) {
      const Truth truth = Truth::from_positions(all, all, radius);
      EXPECT_EQ(truth.frames(), 60U);
      for (std::size_t a = 0; a < places.size(); ++a) {
        for (std::size_t b = 0; b < places.size(); ++b) {
          const bool within =
              haversine(places[a][0], places[a][1], places[b][0], places[b][1]) <= radius;
          EXPECT_EQ(truth.right(a, b, 3), within) << a << ' ' << b << ' ' << radius;
          near += within ? 1U : 0U;
        }
      }
    }
    EXPECT_GT(near, 500U);
  }
}

TEST(Truth, OfLoopsIsWhatTheRobotHadLeftInBetween) {
  std::mt19937 random(4);
  std::normal_distribution<double> step(0.0, 3.0);
  std::vector<std::array<double, 2>> driven;
  std::vector<std::string> lines;
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < 120; ++i) {
    if (i % 10 > 2) {  // otherwise it stands
      x += step(random);
      y += step(random);
    }
    driven.push_back({x, y});
    lines.push_back(fmt::format("{},{},{}\n", 3 * i, x, y));
  }
  std::ranges::shuffle(lines, random);
  const Positions drive = positions(fmt::format("frame,x,y\n{}", fmt::join(lines, "")));
  std::size_t loops = 0;
  for (const double radius : {2.0, 6.0, 15.0}) {
    const auto near = [&](std::size_t a, std::size_t b) {
      return std::hypot(driven[a][0] - driven[b][0], driven[a][1] - driven[b][1]) <= radius;
    };
    const Truth truth = Truth::loops_from_positions(drive, radius, Unlisted::unknown);
    for (std::size_t query = 0; query < driven.size(); ++query) {
      for (std::size_t match = 0; match < driven.size(); ++match) {
        bool left = false;
        for (std::size_t k = match + 1; k < query; ++k) left = left || !near(k, query);
        const bool loop = left && near(match, query);
        EXPECT_EQ(truth.right(3 * query, 3 * match, 9), loop) << query << ' ' << match;
        loops += loop ? 1U : 0U;
      }
      EXPECT_TRUE(truth.judges(3 * query, 0)) << "new, where it comes back to nothing";
    }
    EXPECT_FALSE(truth.judges(1, 0));
    EXPECT_FALSE(truth.judges(3, 1));
  }
  EXPECT_GT(loops, 500U);
  const Positions ahead = positions("frame,x,y\n0,0,0\n1,9,0\n2,18,0\n");
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)Truth::loops_from_positions(ahead, 10.0); }),
                         "no-revisit"));
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)Truth::loops_from_positions(ahead, 0.0); }),
                         "above 0"));
  const Positions round =
      positions("frame,latitude,longitude\n0,60,10\n1,60.001,10\n2,60.0001,10\n");
  EXPECT_TRUE(Truth::loops_from_positions(round, 20.0).right(2, 0, 0)) << "11 m over the ground";
  EXPECT_THROW((void)Truth::loops_from_positions(round, 10.0), SetupError);
}

TEST(Truth, ADegreeOfLatitudeIs111Kilometres) {
  const Positions south = positions("frame,latitude,longitude\n0,0,0\n");
  const Positions north = positions("frame,latitude,longitude\n0,1,0\n");
  EXPECT_EQ(Truth::from_positions(south, north, 111'196.0).frames(), 1U);  // 2 pi R / 360
  EXPECT_THROW((void)Truth::from_positions(south, north, 111'194.0), SetupError);
  const Positions behind = positions("frame,latitude,longitude\n0,0,180\n");
  EXPECT_EQ(Truth::from_positions(south, behind, 1e9).frames(), 1U) << "farther than any way is";
}

TEST(Truth, TenThousandByTenThousandPositions) {
  std::string text = "frame,x,y\n";
  for (int i = 0; i < 10'000; ++i) text += fmt::format("{},{},{}\n", i, i, 0.001 * i);
  const Positions all = positions(text);  // all in one band
  const Truth truth = Truth::from_positions(all, all, 25.0);
  EXPECT_EQ(truth.frames(), 10'000U);
  EXPECT_TRUE(truth.right(5000, 5024, 0));
  EXPECT_FALSE(truth.right(5000, 5025, 0)) << "0.025 m to the north make it a little farther";
}

TEST(Truth, PositionsThatAreNone) {
  const auto refused = [](const std::string& text) {
    return test::setup_error([&] { (void)positions(text); });
  };
  EXPECT_TRUE(test::says(refused("frame,x\n1,2\n"), "frame,latitude,longitude"));
  EXPECT_TRUE(test::says(refused("x,y\n1,2\n"), "frame,x,y"));
  EXPECT_TRUE(test::says(refused("frame,x,y,latitude,longitude\n1,2,3,4,5\n"), "columns"));
  EXPECT_TRUE(test::says(refused("frame,x,y\n"), "no rows"));
  EXPECT_TRUE(test::says(refused("frame,x,y\n1,0,0\n2,0,0\n1,5,5\n"), "p.csv:4: frame 1"));
  EXPECT_TRUE(test::says(refused("frame,x,y\n1,nan,0\n"), "p.csv:2: 'nan' under 'x'"));
  EXPECT_TRUE(test::says(refused("frame,x,y\n1,0,inf\n"), "'inf'"));
  EXPECT_TRUE(test::says(refused("frame,latitude,longitude\n1,91,0\n"), "from -90 to 90"));
  EXPECT_TRUE(test::says(refused("frame,latitude,longitude\n1,0,-181\n"), "longitude"));
  const Positions plan = positions("frame,x,y\n1,0,0\n");
  const Positions earth = positions("frame,latitude,longitude\n1,0,0\n");
  const auto truth = [](const Positions& reference, const Positions& query, double radius) {
    return test::setup_error([&] { (void)Truth::from_positions(reference, query, radius); });
  };
  EXPECT_TRUE(test::says(truth(plan, earth, 25.0), "alike"));
  for (const double radius : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_TRUE(test::says(truth(plan, plan, radius), "radius"));
  }
  EXPECT_TRUE(test::says(truth(plan, positions("frame,x,y\n1,99,0\n"), 25.0), "widen"));
}

}  // namespace
}  // namespace seqloop::evaluation
