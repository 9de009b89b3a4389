// SPDX-License-Identifier: MIT
// What the headers promise of answers holds whatever the configuration, and whatever comes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include "core/chance.hpp"
#include "core/matcher.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

constexpr std::size_t size = 24;  // values in a descriptor

MatcherConfig any_config(Chance& chance) {
  MatcherConfig config;
  config.candidates = chance.one_of(
      {Candidates::all, Candidates::ranges, Candidates::adaptive, Candidates::adaptive});
  config.use = chance.one_of({Use::localise, Use::close_loops});
  config.arithmetic = chance.one_of({Arithmetic::float32, Arithmetic::int8, Arithmetic::sketch});
  config.sequence_length = chance.one_of<std::size_t>({0, 1, 2, 5, 12, 20});
  config.num = chance.between(1, 40);
  config.exclude = chance.one_of<std::size_t>({20, 30, 60});
  config.full_map = chance.one_of({FullMap::refuse, FullMap::forget_oldest, FullMap::thin});
  config.relocalising.on = !chance.one_in(4);
  config.relocalising.rows_scanned = chance.one_of<std::size_t>({20, 37, 4096});
  config.standardisation.on = !chance.one_in(3);
  config.blank_is_unreadable = chance.one_in(2);
  config.keyframes = !chance.one_in(4);
  config.min_probability = chance.one_of({0.99F, 0.5F, 0.01F, 1.0F});
  config.patience = chance.one_of<std::size_t>({0, 1, 10, 60, 120});
  config.frames_at_once = chance.one_of<std::size_t>({1, 2, 17});
  return config;
}

/// A descriptor that may be none. @return whether it can be read
bool spoil(std::vector<float>& seen, const MatcherConfig& config, Chance& chance) {
  switch (chance.between(0, 3)) {
    case 0:
      seen.assign(size, 0.0F);
      return !config.blank_is_unreadable;
    case 1:
      seen.clear();
      return false;
    case 2:
      seen[5] = std::numeric_limits<float>::quiet_NaN();
      return false;
    default:
      for (float& value : seen) value *= 3.0F;
      return false;
  }
}

/// Follows what is said of a drive.
struct Heard {
  const MatcherConfig& config;
  const PlaceMap& map;
  float least = config.min_probability;
  std::set<std::uint64_t> waiting{};
  std::set<std::uint64_t> unreadable{};
  std::size_t named = 0;

  void hear(std::span<const Answer> answers) {
    EXPECT_TRUE(std::ranges::is_sorted(answers, std::ranges::less_equal{}, &Answer::frame));
    for (const Answer& answer : answers) {
      SCOPED_TRACE("answer to " + std::to_string(answer.frame));
      EXPECT_EQ(waiting.erase(answer.frame), 1U) << "it has one already, or never came";
      EXPECT_TRUE(answer.probability >= 0.0F && answer.probability <= 1.0F) << answer.probability;
      EXPECT_EQ(answer.gate == Gate::frame_error, unreadable.contains(answer.frame));
      EXPECT_EQ(answer.gate == Gate::match, answer.match && answer.probability >= least)
          << answer.probability;
      if (!answer.match) continue;
      ++named;
      const auto place = map.order().row_of_number(answer.match->place);
      const auto head = map.order().row_of_number(answer.match->head);
      EXPECT_TRUE(place && head && map.order().apart(*place, *head) != PlaceOrder::far);
    }
  }

  void hear(const FrameReport& report, bool readable, const Work& most) {
    waiting.insert(report.newest);
    if (!readable) unreadable.insert(report.newest);
    hear(report.answers);
    if (!waiting.empty()) {
      EXPECT_LT(report.newest - *waiting.begin(), config.patience) << "frames wait for too long";
    }
    EXPECT_LE(report.work.candidates, most.candidates);
    EXPECT_LE(report.work.distances, most.distances);
    EXPECT_LE(report.work.line_sums, most.line_sums);
    EXPECT_LE(report.work.scanned, most.scanned);
    EXPECT_LE(report.work.sketches, most.sketches);
    if (!report.now) return;
    EXPECT_TRUE(map.order().row_of_number(report.now->place));
    EXPECT_TRUE(report.now->probability >= 0.0F && report.now->probability <= 1.0F);
  }
};

/// A map, and a detector in memory that held something else before.
struct Setup {
  Setup(const MatcherConfig& config, const Capacity& room, const oracle::Vectors& earlier,
        std::size_t columns)
      : map(config, room), memory(Detector::bytes_needed(config, room), {}) {
    EXPECT_TRUE(map.set_columns(columns));
    fill(map, earlier);
    std::memset(memory.span().data(), 0xCD, memory.span().size());
    detector.emplace(config, map, memory.span());
  }

  PlaceMap map;
  ArenaMemory memory;
  std::optional<Detector> detector;
};

bool same(const Answer& a, const Answer& b) {
  return a.frame == b.frame && a.gate == b.gate && a.probability == b.probability &&
         a.match.has_value() == b.match.has_value() &&
         (!a.match || (a.match->place == b.match->place && a.match->head == b.match->head &&
                       a.match->stood == b.match->stood));
}

/// @return answers that named a place
std::size_t play(std::uint32_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Chance chance(seed);
  const MatcherConfig config = any_config(chance);
  EXPECT_TRUE(validate(config).empty());
  const std::size_t known = chance.between(25, 120);
  const bool knows = config.use == Use::localise || chance.one_in(2);
  const Capacity room{std::max(least_places(config), known) + chance.between(0, 60), size, 2};
  const oracle::Vectors earlier = knows ? test::way(seed, known, 0.3F, 1, size) : oracle::Vectors{};
  const oracle::Vectors way = test::way(seed, known, 0.3F, 2, size);
  const auto columns = chance.one_of<std::size_t>({0, 1, 4, size});
  Setup one(config, room, earlier, columns);
  Setup twin(config, room, earlier, columns);
  const Work most = Detector::most_work(config, room);
  Heard heard{config, one.map};
  std::vector<FrameReport> reports(config.frames_at_once);
  std::size_t at = 0;
  for (std::size_t step = 0; step < 220 && !testing::Test::HasFailure(); ++step) {
    // Both are told of so many frames, the twin of all at once.
    std::vector<std::vector<float>> frames;
    std::vector<std::vector<Answer>> answers;
    for (std::size_t i = chance.between(1, config.frames_at_once); i > 0; --i) {
      frames.push_back(way[at % known]);
      at = chance.one_in(60) ? chance.between(0, known) : at + (chance.one_in(4) ? 0 : 1);
      const bool readable = !chance.one_in(20) || spoil(frames.back(), config, chance);
      const FrameReport report = one.detector->step(frames.back());
      heard.hear(report, readable, most);
      answers.emplace_back(report.answers.begin(), report.answers.end());
    }
    const std::vector<std::span<const float>> spans(frames.begin(), frames.end());
    EXPECT_EQ(twin.detector->steps(spans, reports), frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(reports[i].answers, answers[i], same)) << "frame " << step;
    }
    if (chance.one_in(30)) {
      const std::size_t gap = chance.one_of<std::size_t>({1, 3, 20, 100});
      for (Setup* const setup : {&one, &twin}) setup->detector->skip(gap);
    }
    if (chance.one_in(40)) {
      heard.least = chance.one_of({0.99F, 0.3F, 1.0F});
      for (Setup* const setup : {&one, &twin}) setup->detector->accept_from(heard.least);
    }
    if (step + 1 < 220 && !chance.one_in(90)) continue;
    heard.hear(one.detector->finish());
    EXPECT_TRUE(heard.waiting.empty());
    static_cast<void>(twin.detector->finish());
  }
  return heard.named;
}

TEST(Promises, HoldWhateverComes) {
  std::size_t named = 0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) named += play(seed);
  std::printf("%zu answers named a place\n", named);
  EXPECT_GT(named, 5'000U);
}

}  // namespace
}  // namespace seqloop
