// SPDX-License-Identifier: MIT
// Text from outside, damaged at random: always an answer or a SetupError, never a crash. What
// descriptor files and pictures do is tested with their readers.
#include <algorithm>
#include <random>

#include "evaluation/measures.hpp"
#include "experiment/run/experiment.hpp"
#include "experiment/run/kept_result.hpp"
#include "gtest/gtest.h"
#include "program/options/config_file.hpp"
#include "program/options/matcher_settings.hpp"
#include "temporary_folder.hpp"

namespace seqloop {
namespace {

/// One to eight bytes changed, inserted, removed or doubled.
std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  static constexpr std::string_view spice = "0123456789,.-+einf\n\r\t \"'[]{}=#\\x\0\xff";
  for (std::size_t times = 1 + below(8); times > 0; --times) {
    if (text.empty()) return text;
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0:
        text[at] = spice[below(spice.size())];
        break;
      case 1:
        text.insert(at, 1, spice[below(spice.size())]);
        break;
      case 2:
        text.erase(at, 1 + below(20));
        break;
      default:
        text.insert(at, text.substr(at, 1 + below(30)));
    }
  }
  return text;
}

template <class Read>
void fuzz(const std::string& good, std::uint32_t seed, Read read) {
  std::mt19937 random(seed);
  std::size_t taken = 0;
  std::size_t refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    const std::string text = damaged(good, random);
    try {
      read(text) ? ++taken : ++refused;
    } catch (const SetupError& error) {
      ASSERT_FALSE(error.faults().empty()) << text;
      ++refused;
    }
  }
  std::printf("seed %u: %zu taken, %zu refused\n", seed, taken, refused);
  EXPECT_GT(taken, 100U);
  EXPECT_GT(refused, 100U);
}

TEST(ReaderFuzz, MatchLists) {
  fuzz("query,match,uniqueness,probability,accepted\n1,2,0.25,1,1\n2,3,nan,nan,0\n3,4,inf,.5,1\n",
       1, [](const std::string& text) {
         const auto answers =
             evaluation::parse_answers(text, "m.csv", evaluation::ThresholdOn::uniqueness);
         const auto measures = evaluation::measure(answers, evaluation::Truth::identity(10), 2, 10);
         EXPECT_LE(measures.correct, measures.answered);
         EXPECT_LE(measures.precision, 1.0);
         EXPECT_LE(measures.accepted.value_or(0), measures.answered);
         EXPECT_FALSE(expected_calibration_error(measures.reliability) > 1.0);
         return true;
       });
}

TEST(ReaderFuzz, LinesOfARun) {
  fuzz(R"({"frame":1,"match":2,"uniqueness":0.5}
{"frame":null,"match":null,"uniqueness":null}
{"answers":[{"frame":2,"match":3,"uniqueness":1e-3},{"frame":3,"match":7,"uniqueness":null}]}
)",
       6, [](const std::string& text) {
         const auto answers =
             evaluation::parse_answers(text, "r.jsonl", evaluation::ThresholdOn::uniqueness);
         for (const evaluation::Answer& answer : answers)
           EXPECT_LE(std::max(answer.query, answer.match), std::uint64_t{1} << 62U);
         return true;
       });
}

TEST(ReaderFuzz, Truths) {
  fuzz("query,reference\r\n1,2\r\n2,3\r\n", 2, [](const std::string& text) {
    const auto truth = evaluation::Truth::from_csv(evaluation::CsvTable(text, "t.csv"));
    EXPECT_GE(truth.frames(), 1U);
    return true;
  });
}

TEST(ReaderFuzz, Positions) {
  fuzz("frame,latitude,longitude\n1,63.5,10.25\n2,-1e1,179.5\n", 4, [](const std::string& text) {
    const auto positions = evaluation::Positions::from_csv(evaluation::CsvTable(text, "p.csv"));
    EXPECT_GE(positions.places.size(), 1U);
    return true;
  });
}

TEST(ReaderFuzz, ConfigurationFiles) {
  program::MatcherSettings settings;
  program::OptionTable table;
  program::add_matcher_options(table, settings);
  std::vector<std::string> known;
  for (const auto& option : table.options()) known.push_back(option.name);
  fuzz("ds = 20\nvmin = 0.8\nmethod = \"seqcnnslam\"\nstandardise = \"on\"\npaper = true\n", 3,
       [&](const std::string& text) {
         return program::apply_config_text(text, "c.toml", table, {}, known).empty();
       });
}

TEST(ReaderFuzz, Experiments) {
  const std::string good = R"(title = "t"
[[drive]]
name = "a"
source = "a"
crop = "48x32+8+0"
[[descriptor]]
name = "d"
remove-components = [1, 2]
training = ["a"]
[[pair]]
name = "p"
reference = "a"
query = "a"
[[method]]
name = "m"
descriptor = ["d"]
method = "seqcnnslam"
ds = [5, 6]
[[figure]]
where = { ds = 5 }
[[table]]
rows = "method"
values = "recall"
)";
  fuzz(good, 4, [](const std::string& text) {
    Faults faults;
    const auto experiment = experiment::parse_experiment(text, "e.toml", "", faults);
    for (const auto& run : experiment.runs) EXPECT_LT(run.pair, experiment.pairs.size());
    return faults.empty();
  });
}

TEST(ReaderFuzz, KeptResults) {
  const test::TemporaryFolder folder;
  experiment::Result result;
  result.settings = {{"ds", "20"}};
  result.measures.curve = {{0.25, 1.0}, {0.5, 0.75}};
  keep_result(result, folder.path() / "r.json");
  fuzz(test::read_all(folder.path() / "r.json"), 5,
       [](const std::string& text) { return experiment::parse_result(text).has_value(); });
}

}  // namespace
}  // namespace seqloop
