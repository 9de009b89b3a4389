// SPDX-License-Identifier: MIT
// Which row an answer names, given what sequence search has found.
#include "seqloop/detail/pending_answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/seen.hpp"
#include "core/ways.hpp"

namespace seqloop {
namespace {

MatcherConfig not_standardised() {
  MatcherConfig config;
  config.standardisation.on = false;
  return config;
}

/// Drives past a known way.
struct Passing {
  explicit Passing(const MatcherConfig& of = not_standardised()) : config(of) {}

  /// @param rows that sequence search finds, by frame: each by one line, of `velocity` and through
  ///   that row, once a whole window has come
  /// @return the answers of this step, until the next
  std::span<const Answer> step(const std::vector<float>& descriptor,
                               const std::vector<std::optional<std::size_t>>& rows) {
    pending.clear();
    const SceneView view = seen.take(descriptor);
    pending.add(view.newest, true);
    static_cast<void>(belief.observe(view, pending.chance_of_return(view.newest)));
    const std::size_t after = lines.window() - 1 - lines.centre();
    const auto centre = static_cast<std::size_t>(view.newest - after);
    if (view.newest >= lines.window() - 1 && centre < rows.size() && rows[centre]) {
      std::size_t line = 0;
      while (std::abs(lines.velocity(line) - velocity) > 1e-9) ++line;
      const std::array lines_found{FoundLine{*rows[centre], 0.5, 0.5, line},
                                   FoundLine{(*rows[centre] + 100) % 200, elsewhere, 0.5, line}};
      pending.found(centre, std::span(lines_found).first(elsewhere > 0.0 ? 2 : 1));
    }
    pending.believe(belief, seen.map, view.newest, 0);
    pending.answer(seen.map, steps, view.newest, 0);
    return pending.answers();
  }

  MatcherConfig config;
  double elsewhere = 0.0;  ///< score of a line through the row 100 away, where the other has .5
  double velocity = 1.0;
  Seen seen{test::way(1, 200, 0.3F, 1), config};
  Trajectories lines{seen.memory.arena, config.sequence_length, config.vmin, config.vmax};
  PlaceBelief belief{seen.memory.arena, config};
  FrameSteps steps{seen.memory.arena, 0, 0};  // each frame is one
  PendingAnswers pending{seen.memory.arena, config, lines};
};

TEST(PendingAnswers, KnowWhereTheWayLeads) {
  Passing drive;
  TestArena memory;
  PlaceOrder order(memory.arena, 400, 2);  // of two drives; the robot is on the first
  for (std::uint64_t frame = 0; frame < 200; ++frame) order.append(frame);
  ASSERT_TRUE(order.begin_session());
  for (std::uint64_t frame = 0; frame < 200; ++frame) order.append(frame);
  EXPECT_FALSE(drive.pending.leads_to(order, 0, 0)) << "it was found nowhere";
  std::optional<std::uint64_t> found;
  for (const auto& seen : test::way(1, 200, 0.3F, 2)) {
    for (const Answer& answer : drive.step(seen, {})) {
      if (answer.gate != Gate::match) continue;
      ASSERT_EQ(answer.match->place, answer.frame);
      found = answer.frame;
    }
  }
  ASSERT_TRUE(found);
  ASSERT_GT(*found, 160U);
  const auto leads = [&](std::uint64_t after, std::size_t row) {
    return drive.pending.leads_to(order, *found + after, row);
  };
  const auto row = static_cast<std::size_t>(*found);
  EXPECT_TRUE(leads(0, row));
  EXPECT_TRUE(leads(0, row + 6));
  EXPECT_FALSE(leads(0, row + 7));
  EXPECT_TRUE(leads(4, row + 4 - 7));
  EXPECT_FALSE(leads(4, row + 4 - 8));
  // Behind the end of the drive there is no way, and soon none to its last row.
  const std::uint64_t beyond = 210 - *found;
  EXPECT_TRUE(leads(beyond, 199));
  EXPECT_FALSE(leads(beyond, 200));
  EXPECT_FALSE(leads(beyond, 210));
  EXPECT_FALSE(leads(120, 199));
}

/// Of a whole drive. @param rows that sequence search finds, by frame
std::vector<Answer> answers_of(Passing& passing, const oracle::Vectors& query,
                               const std::vector<std::optional<std::size_t>>& rows) {
  std::vector<Answer> answers;
  const auto take = [&](std::span<const Answer> some) {
    answers.insert(answers.end(), some.begin(), some.end());
  };
  for (const auto& descriptor : query) take(passing.step(descriptor, rows));
  passing.pending.clear();
  passing.pending.answer(passing.seen.map, passing.steps, query.size() - 1, query.size());
  take(passing.pending.answers());
  return answers;
}

/// The same past a known way. @param elsewhere as `Passing` has it
std::vector<Answer> answers_with_lines(const oracle::Vectors& query,
                                       const std::vector<std::optional<std::size_t>>& rows,
                                       double elsewhere = 0.0) {
  Passing passing;
  passing.elsewhere = elsewhere;
  return answers_of(passing, query, rows);
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
    std::vector<std::optional<std::size_t>> rows;
    for (std::int64_t i = 0; i < 200; ++i) {
      rows.emplace_back(static_cast<std::size_t>(std::max<std::int64_t>(i + line, 0)));
    }
    for (const Answer& answer : answers_with_lines(test::way(1, 200, 0.3F, 2), rows)) {
      if (answer.frame < 40 || answer.frame >= 140) continue;
      ++asked;
      ASSERT_EQ(answer.gate, Gate::match);
      EXPECT_EQ(static_cast<std::int64_t>(answer.match->place),
                static_cast<std::int64_t>(answer.frame) + place);
    }
    EXPECT_EQ(asked, 100U);
  }
}

/// The line of one frame is four rows off. Where its window shows another place better, or it is as
/// slow or as fast as lines are, those of the frames beside it come first.
TEST(PendingAnswers, NameTheRowByALineThatShowsNoOtherPlaceBetterNorMayBeTooFast) {
  const oracle::Vectors query = test::way(1, 200, 0.3F, 2);
  constexpr std::size_t asked = 100;
  std::vector<std::optional<std::size_t>> rows;
  for (std::size_t i = 0; i < query.size(); ++i) rows.emplace_back(i == asked ? i + 4 : i);
  const auto place_where = [&](double elsewhere, double velocity) {
    Passing passing;
    const std::size_t after = passing.lines.window() - 1 - passing.lines.centre();
    std::optional<std::uint64_t> place;
    for (std::size_t i = 0; i < query.size(); ++i) {
      passing.elsewhere = i == asked + after ? elsewhere : 0.6;
      passing.velocity = i == asked + after ? velocity : 1.0;
      for (const Answer& answer : passing.step(query[i], rows)) {
        if (answer.frame == asked && answer.match) place = answer.match->place;
      }
    }
    return place;
  };
  const MatcherConfig config = not_standardised();
  EXPECT_EQ(place_where(0.6, 1.0), asked + 2) << "half way between its line and the trace";
  EXPECT_EQ(place_where(0.4, 1.0), asked);
  EXPECT_EQ(place_where(0.6, config.vmin), asked);
  EXPECT_EQ(place_where(0.6, config.vmax), asked);
  EXPECT_EQ(place_where(0.6, config.vmin + 1.0 / static_cast<double>(config.sequence_length)),
            asked + 2);
}

/// Lines through another visit of the place that a trace goes through are its own.
TEST(PendingAnswers, NameTheRowOfAnotherVisit) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  const oracle::Vectors query(known.begin(), known.begin() + 100);
  std::vector<std::optional<std::size_t>> rows;
  for (std::size_t i = 0; i < query.size(); ++i) rows.emplace_back(100 + i);
  for (const bool one_place : {true, false}) {
    SCOPED_TRACE(one_place);
    Passing passing;
    for (std::size_t i = 0; one_place && i < query.size(); ++i) passing.seen.map.link(100 + i, i);
    std::size_t asked = 0;
    for (const Answer& answer : answers_of(passing, query, rows)) {
      if (answer.frame < 20 || answer.frame >= 80) continue;
      ++asked;
      ASSERT_TRUE(answer.match);
      EXPECT_EQ(answer.gate == Gate::match, one_place);
      EXPECT_EQ(answer.match->place, answer.frame + (one_place ? 100 : 0));
      EXPECT_EQ(std::isnan(answer.match->score), !one_place);
    }
    EXPECT_EQ(asked, 60U);
  }
}

/// Where the robot stands, nothing says whether it is still on its trace.
TEST(PendingAnswers, WaitWhileALocalisingRobotMayHaveLeft) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  constexpr std::size_t stands_from = 100;
  oracle::Vectors query(known.begin(), known.begin() + stands_from);
  query.insert(query.end(), 100, query.back());
  for (const Use use : {Use::localise, Use::close_loops}) {
    SCOPED_TRACE(static_cast<int>(use));
    MatcherConfig config = not_standardised();
    config.use = use;
    Passing passing(config);
    std::uint64_t answered = 0;
    for (const auto& descriptor : query) {
      for (const Answer& answer : passing.step(descriptor, {})) answered = answer.frame + 1;
    }
    EXPECT_GE(answered, stands_from - 1);
    EXPECT_EQ(answered > stands_from, use == Use::close_loops) << answered;
  }
}

/// The robot stands at the end of each piece of its way, so that nothing says when it was carried
/// away to the next.
TEST(PendingAnswers, AreTheLessSureTheOftenerTheRobotIsCarriedAway) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  constexpr std::size_t drives = 40;
  constexpr std::size_t piece = 50;
  oracle::Vectors query;
  std::vector<std::optional<std::size_t>> rows;
  for (std::size_t i = 0; i < 12 * piece; ++i) {
    const std::size_t first = i / piece % 2 == 0 ? 20 : 120;
    rows.push_back(first + std::min(i % piece, drives));
    query.push_back(known[*rows.back()]);
  }
  std::vector<std::size_t> accepted(12, 0);
  for (const Answer& answer : answers_with_lines(query, rows)) {
    accepted[static_cast<std::size_t>(answer.frame) / piece] +=
        static_cast<std::size_t>(answer.gate == Gate::match);
  }
  for (std::size_t i = 1; i < accepted.size(); ++i) {
    EXPECT_LT(accepted[i] + 5, accepted[0]) << i;
    EXPECT_GT(accepted[i], 30U) << i;
  }
}

/// The robot is carried from piece to piece of its way, and sees little at first. Where the windows
/// of a piece's first frames go along its trace much better than elsewhere, it was there.
TEST(PendingAnswers, AreSureAfterJumpsWhereTheirOwnWindowsAgree) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  const oracle::Vectors unclear = test::way(1, 200, 2.2F, 3);
  constexpr std::size_t piece = 60;
  oracle::Vectors query;
  std::vector<std::optional<std::size_t>> rows;
  for (std::size_t i = 0; i < 8 * piece; ++i) {
    rows.emplace_back((i / piece % 2 == 0 ? 20 : 120) + i % piece);
    query.push_back((i % piece < 10 ? unclear : known)[*rows.back()]);
  }
  struct Sure {
    std::size_t first = 0;  // of the first ten frames of the last four pieces
    std::size_t later = 0;  // of the next twenty
    std::size_t last = 0;   // of the last thirty
  };
  const auto sure = [&](double margin) {
    Sure count;
    for (const Answer& answer : answers_with_lines(query, rows, 0.5 * std::exp(margin))) {
      const auto frame = static_cast<std::size_t>(answer.frame);
      if (frame < 4 * piece || answer.gate != Gate::match) continue;
      EXPECT_NEAR(static_cast<double>(answer.match->place), static_cast<double>(*rows[frame]), 1.0);
      count.first += static_cast<std::size_t>(frame % piece < 10);
      count.last += static_cast<std::size_t>(frame % piece >= 30);
      count.later += static_cast<std::size_t>(frame % piece >= 10 && frame % piece < 30);
    }
    return count;
  };
  EXPECT_GE(sure(0.11).first, 32U);
  EXPECT_EQ(sure(0.11).later, 80U);
  // Of a window that shows another place, too, more is asked.
  EXPECT_LE(sure(0.09).first, 24U);
  EXPECT_EQ(sure(0.05).later, 80U);
  EXPECT_LT(sure(-0.05).later, 80U) << "another place's line is better";
  // A whole window has to go on along the trace.
  EXPECT_EQ(sure(0.05).last, 101U);
}

/// Windows overlap, so that the first frames after a jump look as if they were on the trace before
/// it: where there have been jumps, its last ones are not believed.
TEST(PendingAnswers, AreNotSureOfTheLastFramesOfATraceAfterJumps) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  const oracle::Vectors foreign = test::way(9, 60, 0.3F, 2);
  const auto last_accepted = [&](std::initializer_list<std::size_t> pieces) {
    oracle::Vectors query;
    std::vector<std::optional<std::size_t>> rows;
    for (const std::size_t first : pieces) {
      for (std::size_t row = first; row < first + 60; ++row) {
        rows.emplace_back(row);
        query.push_back(known[row]);
      }
    }
    const std::size_t end = query.size();
    query.insert(query.end(), foreign.begin(), foreign.end());
    rows.resize(query.size());
    std::uint64_t last = 0;
    for (const Answer& answer : answers_with_lines(query, rows)) {
      if (answer.gate == Gate::match) last = std::max(last, answer.frame);
    }
    return end - 1 - last;
  };
  EXPECT_EQ(last_accepted({20, 80}), 0U) << "one way on";
  EXPECT_EQ(last_accepted({20, 120}), 2U) << "after a jump";
}

/// What lies behind the end of an earlier drive may look like what lies before it. One that is
/// carried about comes to other rows anyway.
TEST(PendingAnswers, AskForMoreBehindTheEndOfADrive) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  struct Asked {
    double most = 0.0;   // of the last piece's frames
    double jumps = 0.0;  // the chance of one then
  };
  const auto asked_after = [&](std::initializer_list<CandidateRun> pieces) {
    Passing passing;
    Asked asked;
    for (const auto& [first, last] : pieces) {
      asked = {};
      for (std::size_t row = first; row < last; ++row) {
        const double jumps = passing.pending.jumps();  // what the frame is judged by
        static_cast<void>(passing.step(known[row], {}));
        const std::optional<Evidence>& evidence = passing.pending.evidence();
        if (evidence && evidence->asked > asked.most) asked = {evidence->asked, jumps};
      }
    }
    return asked;
  };
  EXPECT_EQ(asked_after({{60, 140}, {20, 50}}).most, 0.0) << "in the middle of it";
  EXPECT_EQ(asked_after({{60, 190}, {190, 200}}).most, 0.0) << "up to its end";
  const Asked beyond = asked_after({{60, 200}, {20, 50}});
  EXPECT_EQ(beyond.most, 2.2);
  EXPECT_EQ(beyond.jumps, 0.0);
  const Asked carried = asked_after({{20, 80}, {120, 200}, {20, 50}});
  EXPECT_GT(carried.jumps, 0.01);
  EXPECT_DOUBLE_EQ(carried.most, 2.2 * (1.0 - 10.0 * carried.jumps));
}

/// Which side of a jump a frame was on is known less well than where either side is.
TEST(PendingAnswers, AreNotSureOfTheFramesWhereTwoTracesMeet) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  oracle::Vectors query(known.begin(), known.begin() + 60);
  query.insert(query.end(), known.begin() + 120, known.end());
  std::vector<std::optional<std::size_t>> rows(query.size());
  for (std::size_t i = 0; i < query.size(); ++i) rows[i] = i < 60 ? i : i + 60;
  std::size_t sure = 0;
  const std::vector<Answer> answers = answers_with_lines(query, rows);
  EXPECT_EQ(answers.size(), query.size());
  for (const Answer& answer : answers) {
    SCOPED_TRACE(answer.frame);
    const bool at_the_jump = answer.frame >= 58 && answer.frame < 62;
    if (at_the_jump) {
      EXPECT_NE(answer.gate, Gate::match);
      EXPECT_LE(answer.probability, 0.95F);
    } else if (answer.frame >= 20 && answer.frame < 100) {
      sure += static_cast<std::size_t>(answer.gate == Gate::match);
    }
  }
  EXPECT_EQ(sure, 76U);
}

/// A row that is left over from an earlier revisit, and that nobody believes in, keeps no frame
/// from the next one's trace.
TEST(PendingAnswers, BeginWithTheRevisit) {
  const oracle::Vectors known = test::way(1, 200, 0.3F, 2);
  const oracle::Vectors foreign = test::way(9, 60, 0.3F, 2);
  oracle::Vectors query(known.begin(), known.begin() + 60);
  query.insert(query.end(), foreign.begin(), foreign.end());
  query.insert(query.end(), known.begin() + 20, known.end());
  std::vector<std::optional<std::size_t>> rows(query.size());
  for (std::size_t i = 0; i < 60; ++i) rows[i] = i;
  for (std::size_t i = 120; i < rows.size(); ++i) rows[i] = i - 100;
  std::size_t found = 0;
  for (const Answer& answer : answers_with_lines(query, rows)) {
    SCOPED_TRACE(answer.frame);
    const bool matched = answer.gate == Gate::match;
    if (matched && !rows[static_cast<std::size_t>(answer.frame)]) ADD_FAILURE();
    if (answer.frame >= 120 && answer.frame < 160) found += static_cast<std::size_t>(matched);
  }
  EXPECT_EQ(found, 40U);
}

}  // namespace
}  // namespace seqloop
