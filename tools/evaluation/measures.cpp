// SPDX-License-Identifier: MIT
#include "evaluation/measures.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop::evaluation {
namespace {

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Sorts undefined behind everything, infinity included.
bool more_certain(const Answer& a, const Answer& b) {
  if (std::isnan(a.uncertainty) || std::isnan(b.uncertainty)) {
    return !std::isnan(a.uncertainty) && std::isnan(b.uncertainty);
  }
  return a.uncertainty < b.uncertainty;
}

double area(const std::vector<CurvePoint>& curve) {
  double sum = 0.0;
  double recall = 0.0;
  double precision = curve.empty() ? 0.0 : curve.front().precision;
  for (const CurvePoint& point : curve) {
    sum += (point.recall - recall) * (point.precision + precision) / 2.0;
    recall = point.recall;
    precision = point.precision;
  }
  return sum;
}

}  // namespace

Measures measure(std::vector<Answer> answers, const Truth& truth, std::uint64_t tolerance,
                 std::uint64_t frames) {
  Measures measures;
  measures.unknown = std::erase_if(
      answers, [&](const Answer& answer) { return !truth.judges(answer.query, answer.match); });
  std::stable_sort(answers.begin(), answers.end(), more_certain);
  std::uint64_t accepted = 0;
  std::uint64_t accepted_correct = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Answer& answer = answers[i];
    const bool right = truth.right(answer.query, answer.match, tolerance);
    ++measures.answered;
    measures.correct += right ? 1U : 0U;
    if (answer.accepted.value_or(false)) {
      ++accepted;
      accepted_correct += right ? 1U : 0U;
    }
    add_answer(measures.reliability, answer.probability, right);
    if (i + 1 < answers.size() && !more_certain(answer, answers[i + 1])) continue;
    measures.curve.push_back(
        {ratio(measures.correct, frames), ratio(measures.correct, measures.answered)});
    if (measures.correct == measures.answered) {
      measures.recall_at_100_precision = measures.curve.back().recall;
    }
  }
  measures.precision = ratio(measures.correct, measures.answered);
  measures.recall = ratio(measures.correct, frames);
  measures.area_under_curve = area(measures.curve);
  const auto says = [](const Answer& answer) { return answer.accepted.has_value(); };
  if (std::ranges::all_of(answers, says)) {
    measures.accepted = accepted;
    if (accepted > 0) measures.accepted_precision = ratio(accepted_correct, accepted);
    if (frames > 0) measures.accepted_recall = ratio(accepted_correct, frames);
  }
  return measures;
}

}  // namespace seqloop::evaluation
