// SPDX-License-Identifier: MIT
// The whole map is in sight: how soon each row is looked at, and how soon a carried robot is found.
#include "seqloop/detail/candidate_proposals.hpp"

#include <algorithm>
#include <random>
#include <tuple>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

MatcherConfig sketched(Use use, std::size_t scanned) {
  MatcherConfig config = paper(Candidates::adaptive, 0, use);
  config.arithmetic = Arithmetic::int8;
  config.relocalising.on = true;
  config.relocalising.rows_scanned = scanned;
  return config;
}

bool proposed(const CandidateProposals& proposals, std::size_t row) {
  return std::ranges::any_of(proposals.proposals(),
                             [&](const CandidateProposals::Proposal& proposal) {
                               return proposal.centre == row && proposal.difference == 0.0;
                             });
}

TEST(CandidateProposals, LookAtEveryRowOnceInARound) {
  constexpr std::size_t places = 100;
  const oracle::Vectors drive = oracle::drive(1, places, 32);
  for (const std::size_t scanned : {2U, 7U, 33U, 50U, 99U, 100U, 4096U}) {
    const MatcherConfig config = sketched(Use::localise, scanned);
    const PlaceMap map = map_of(drive, config);
    TestArena memory;
    QueryHistory queries(memory.arena, DescriptorForm(config, 32), 12);
    CandidateProposals proposals(memory.arena, config, places);
    const std::size_t round = (places + scanned - 1) / scanned;
    for (std::size_t row = 0; row < places; ++row) {
      queries.push(drive[row]);
      proposals.restart();
      for (std::size_t frame = 0; frame < round; ++frame) {
        const auto looks = proposals.look(queries, map, places, queries.newest(), queries.newest());
        EXPECT_LE(looks.scanned, CandidateProposals::most_looks(config, places).scanned);
        EXPECT_LE(looks.closely, CandidateProposals::most_looks(config, places).closely);
      }
      EXPECT_TRUE(proposed(proposals, row)) << "row " << row << ", scanned " << scanned;
    }
  }
}

// While the map grows by a row a frame, or loses one, each scan gains one row less.
std::size_t round_of_a_moving_map(std::size_t places, std::size_t scanned) {
  return (places + scanned - 2) / (scanned - 1) + 1;
}

TEST(CandidateProposals, LookAtEveryRowWhileTheMapGrows) {
  constexpr std::size_t places = 300;
  const oracle::Vectors drive = oracle::drive(2, places, 32);
  for (const std::size_t scanned : {2U, 7U, 33U, 64U}) {
    const MatcherConfig config = sketched(Use::localise, scanned);
    const PlaceMap map = map_of(drive, config);
    for (std::size_t row = 0; row < 80; row += 3) {
      TestArena memory;
      QueryHistory queries(memory.arena, DescriptorForm(config, 32), 12);
      CandidateProposals proposals(memory.arena, config, places);
      queries.push(drive[row]);
      std::size_t rows = 80;
      for (std::size_t frame = 0; frame < row; ++frame) {  // wherever the scan has come to
        static_cast<void>(proposals.look(queries, map, rows++, queries.newest(), 0));
      }
      proposals.restart();
      const std::size_t round = round_of_a_moving_map(rows, scanned);
      for (std::size_t frame = 0; frame < round; ++frame) {
        static_cast<void>(
            proposals.look(queries, map, std::min(rows++, places), queries.newest(), 0));
      }
      EXPECT_TRUE(proposed(proposals, row)) << "row " << row << ", scanned " << scanned;
    }
  }
}

TEST(CandidateProposals, LookAtEveryRowWhilePlacesGo) {
  constexpr std::size_t places = 60;
  const oracle::Vectors drive = oracle::drive(3, 400, 32);
  for (const FullMap full_map : {FullMap::forget_oldest, FullMap::thin}) {
    for (const std::size_t scanned : {7U, 16U, 59U, 60U}) {
      MatcherConfig config = sketched(Use::close_loops, scanned);
      config.full_map = full_map;
      config.exclude = 1;
      PlaceMap map(config, {places, 32});
      TestArena memory;
      QueryHistory queries(memory.arena, DescriptorForm(config, 32), 12);
      CandidateProposals proposals(memory.arena, config, places);
      const auto take = [&](std::size_t frame) {
        queries.push(drive[frame]);
        const auto taken =
            map.take(queries.rows(), queries.row_of(queries.newest()), queries.newest(), 1);
        if (taken.removed) proposals.removed(*taken.removed);
      };
      std::size_t frame = 0;
      for (; frame < places; ++frame) take(frame);
      const std::size_t round = round_of_a_moving_map(places, scanned);
      std::size_t found = 0;
      for (std::size_t sought = 0; frame + round < drive.size(); ++sought) {
        const std::uint64_t number = map.order().number((7 * sought) % places);
        proposals.restart();
        bool seen = false;
        bool gone = false;
        for (std::size_t look = 0; look < round && !seen; ++look) {
          take(frame++);
          // Compared as if the robot were at the place again.
          queries.push(drive[static_cast<std::size_t>(number)]);
          static_cast<void>(
              proposals.look(queries, map, places, queries.newest(), queries.newest()));
          std::size_t row = 0;
          while (row < places && map.order().number(row) != number) ++row;
          gone = row == places;
          seen = !gone && proposed(proposals, row);
        }
        EXPECT_TRUE(seen || gone) << "scanned " << scanned << ", number " << number;
        found += seen;
      }
      EXPECT_GT(found, 15U);
    }
  }
}

TEST(CandidateProposals, MoveWithWhatIsRemovedAndWithWhatIsSkipped) {
  const oracle::Vectors drive = oracle::drive(4, 100, 32);
  const MatcherConfig config = sketched(Use::localise, 2);
  const PlaceMap map = map_of(drive, config);
  TestArena memory;
  QueryHistory queries(memory.arena, DescriptorForm(config, 32), 12);
  CandidateProposals proposals(memory.arena, config, 100);
  queries.push(drive[40]);
  for (std::size_t row = 0; row <= 40; row += 2) {
    static_cast<void>(proposals.look(queries, map, 100, queries.newest(), 0));
  }
  ASSERT_TRUE(proposed(proposals, 40));
  proposals.removed(99);
  for (int place = 0; place < 10; ++place) proposals.removed(0);
  proposals.skip(map.order(), 9);
  // 40 less 10 that went, 9 frames and this one further on; the scanned is far from it.
  static_cast<void>(proposals.look(queries, map, 100, queries.newest(), 0));
  EXPECT_TRUE(proposed(proposals, 40));
  proposals.restart();
  EXPECT_TRUE(proposals.proposals().empty());
}

/// How many frames after being put down a robot is found: from then on its answers stay right.
struct Found {
  std::vector<std::size_t> after;  ///< frames, sorted
  std::size_t lost = 0;
};

constexpr std::uint32_t seed = 5;
constexpr std::size_t places = 20'000;

/// The same way twice.
const oracle::Vectors& seen_before() {
  static const oracle::Vectors drive = oracle::drive(seed, places, 128, 0.2F);
  return drive;
}
const oracle::Vectors& seen_again() {
  static const oracle::Vectors drive = oracle::drive(seed, places, 128, 1.0F);
  return drive;
}

/// @param speed rows a frame   @param told whether the detector hears of it (`skip`)
Found carry_about(const MatcherConfig& config, double speed, bool told) {
  constexpr std::size_t stay = 60;
  PlaceMap map = map_of(seen_before(), config);
  Detector detector(config, map);
  std::mt19937 random(seed);
  Found found;
  for (int carried = 0; carried < 50; ++carried) {
    const std::size_t begin = random() % (places - 4 * stay);
    if (told) detector.skip(100'000);
    std::size_t after = 0;
    for (std::size_t frame = 0; frame < stay; ++frame) {
      const std::size_t row = begin + static_cast<std::size_t>(static_cast<double>(frame) * speed);
      const FrameReport report = detector.step(seen_again()[row]);
      const std::uint64_t head = report.match ? report.match->head : places * 2;
      const bool right =
          std::max<std::uint64_t>(head, row) - std::min<std::uint64_t>(head, row) <= 2;
      if (!right) after = frame + 1;
    }
    if (after == stay) {
      ++found.lost;
    } else {
      found.after.push_back(after + 1);
    }
  }
  std::ranges::sort(found.after);
  return found;
}

class Carried : public testing::TestWithParam<Candidates> {};

TEST_P(Carried, IsFoundAgainSoonAtAnySpeed) {
#if defined(__SANITIZE_ADDRESS__)
  const auto whether_told = {true};  // Where it is not, the code is the same, and takes 20 seconds.
#else
  const auto whether_told = {false, true};
#endif
  for (const bool told : whether_told) {
    for (const auto& [vmin, vmax, speed] : {std::tuple{0.8, 1.2, 1.0}, std::tuple{0.8, 1.2, 0.8},
                                            std::tuple{0.0, 3.0, 0.0}, std::tuple{0.0, 3.0, 3.0}}) {
      MatcherConfig config;
      config.decision = Decision::uniqueness;
      config.candidates = GetParam();
      config.vmin = vmin;
      config.vmax = vmax;
      const Found found = carry_about(config, speed, told);
      std::printf(
          "speed %.1f of %.1f to %.1f, %s: found after %zu (least), %zu (median), %zu "
          "(most) frames, %zu of 50 not\n",
          speed, vmin, vmax, told ? "told" : "not told", found.after.front(),
          found.after[found.after.size() / 2], found.after.back(), found.lost);
      const std::size_t scans =
          (places + config.relocalising.rows_scanned - 1) / config.relocalising.rows_scanned;
      EXPECT_EQ(found.lost, 0U);
      EXPECT_LE(found.after.back(), config.sequence_length + 1 + scans);
    }
  }
}

/// Unit vectors that have nothing to do with each other.
oracle::Vectors unlike(std::size_t count) {
  oracle::Vectors all;
  for (std::size_t place = 0; place < count; ++place) {
    all.push_back(oracle::drive(1'000 + static_cast<std::uint32_t>(place), 1, 64).front());
  }
  return all;
}

// Where no place looks like those beside it, only the right rows help.
TEST_P(Carried, IsFoundWhereNeighboursAreNothingAlike) {
  const oracle::Vectors drive = unlike(2'000);
  for (const auto& [vmin, vmax, speed] :
       {std::tuple{0.8, 1.2, 1U}, std::tuple{0.0, 3.0, 1U}, std::tuple{0.0, 3.0, 3U}}) {
    MatcherConfig config;
    config.decision = Decision::uniqueness;
    config.candidates = GetParam();
    config.vmin = vmin;
    config.vmax = vmax;
    PlaceMap map = map_of(drive, config);
    Detector detector(config, map);
    for (const std::size_t begin : {1'000U, 200U, 1'700U}) {
      detector.skip(1'000);
      for (std::size_t frame = 0; frame < 60; ++frame) {
        const std::size_t row = begin + frame * speed;
        const FrameReport report = detector.step(drive[row]);
        // At the speed of the map with the first full window, otherwise a frame later.
        if (frame < config.sequence_length + (speed == 1 ? 0 : 1)) continue;
        ASSERT_TRUE(report.match);
        EXPECT_EQ(report.match->head, row) << "speed " << speed;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Carried,
                         testing::Values(Candidates::ranges, Candidates::adaptive));

}  // namespace
}  // namespace seqloop
