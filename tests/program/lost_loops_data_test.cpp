// SPDX-License-Identifier: MIT
// What tools/loops measures, on those of its drives that take seconds: candidate ranges find what
// exhaustive search finds.
#include <nlohmann/json.hpp>

#include "program/program.hpp"
#include "shared_data.hpp"

namespace seqloop {
namespace {

class LostLoops : public test::Program {
 protected:
  /// @param drive as tools/loops names it. @param least frames that exhaustive search has right
  /// at every sequence length, or the drive shows nothing.
  void expect_none(const std::string& drive, std::size_t least) const {
    SEQLOOP_DATA_OR_SKIP(shared);
    const std::string command = "'" SEQLOOP_LOOPS "' --build '" SEQLOOP_BUILD "' --json --only " +
                                drive + " '" + (shared / "data").string() + "' '" + file("loops") +
                                "' >'" + file("out.json") + "' 2>'" + file("err.txt") + "'";
    ASSERT_EQ(std::system(command.c_str()), 0) << test::read_all(file("err.txt"));
    const auto rows = nlohmann::json::parse(test::read_all(file("out.json")));
    ASSERT_FALSE(rows.empty());
    double exhaustive = 0.0;
    for (const auto& row : rows) {
      const auto method = row["method"].get<std::string>();
      const auto recall = row["recall_at_100_precision"].get<double>();
      std::printf("%s ds %d, %s: %d right, found %.4f, R@100P %.4f\n", drive.c_str(),
                  row["ds"].get<int>(), method.c_str(), row["right"].get<int>(),
                  row["found"].get<double>(), recall);
      if (method == "seqcnnslam") {
        exhaustive = recall;
        EXPECT_GE(row["right"].get<std::size_t>(), least);
      }
      if (method != "o-seqcnnslam") continue;
      EXPECT_GE(row["found"].get<double>(), 0.99) << "ds " << row["ds"];
      EXPECT_GE(recall, exhaustive - 0.01) << "ds " << row["ds"];
    }
  }
};

TEST_F(LostLoops, NoneWhereAWalkIsPassedTwice) { expect_none("b-made", 570); }

TEST_F(LostLoops, NoneWhereGardensPointByNightFollowsTheDay) { expect_none("a-gardens", 160); }

TEST_F(LostLoops, NoneWhereNordlandInWinterFollowsTheSummer) { expect_none("b-nordland", 1030); }

TEST_F(LostLoops, NoneOnGardensPointByNight) { expect_none("d-gardens", 155); }

TEST_F(LostLoops, NoneOnNordlandInWinter) { expect_none("d-nordland", 2200); }

}  // namespace
}  // namespace seqloop
