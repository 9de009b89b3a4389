// SPDX-License-Identifier: MIT
// Which row an answer names, given what sequence search has found.
#include "seqloop/detail/pending_answers.hpp"
#include "core/seen.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

/// Drives a known way whose frame i is row i. Sequence search finds one line for each frame: of
/// velocity 1, so many rows beside the right one.
std::vector<Answer> answers_with_lines(std::int64_t beside) {
  MatcherConfig config;
  config.standardisation.on = false;
  Seen seen(test::way(1, 200, 0.3F, 1), config);
  const Trajectories lines(seen.memory.arena, config.sequence_length, config.vmin, config.vmax);
  std::size_t straight = 0;
  while (lines.velocity(straight) != 1.0) ++straight;
  PlaceBelief belief(seen.memory.arena, config);
  PendingAnswers pending(seen.memory.arena, config, lines);
  std::vector<Answer> answers;
  for (const auto& descriptor : test::way(1, 200, 0.3F, 2)) {
    const SceneView view = seen.take(descriptor);
    pending.add(view.newest, true);
    static_cast<void>(belief.observe(view));
    const std::size_t after = lines.window() - 1 - lines.centre();
    if (view.newest >= lines.window() - 1) {
      const std::uint64_t centre = view.newest - after;
      const auto row = static_cast<std::size_t>(static_cast<std::int64_t>(centre) + beside);
      const FoundLine line{row, 0.5, 0.5, straight};
      pending.found(centre, std::span(&line, 1));
    }
    pending.believe(belief, seen.map, view.newest, 0);
    pending.answer(belief, seen.map, view.newest, 0);
    answers.insert(answers.end(), pending.answers().begin(), pending.answers().end());
    pending.clear();
  }
  return answers;
}

TEST(PendingAnswers, NameTheRowHalfWayBetweenLineAndTrace) {
  struct Case {
    std::int64_t line;
    std::int64_t place;
  };
  // What remains of an odd number goes to the line.
  for (const auto& [line, place] :
       {Case{0, 0}, {1, 1}, {2, 1}, {5, 3}, {6, 3}, {-1, -1}, {-6, -3}}) {
    SCOPED_TRACE(line);
    std::size_t asked = 0;
    for (const Answer& answer : answers_with_lines(line)) {
      if (answer.frame < 40 || answer.frame >= 140) continue;
      ++asked;
      ASSERT_EQ(answer.gate, Gate::match);
      EXPECT_EQ(static_cast<std::int64_t>(answer.match->place),
                static_cast<std::int64_t>(answer.frame) + place);
    }
    EXPECT_EQ(asked, 100U);
  }
}

}  // namespace
}  // namespace seqloop
