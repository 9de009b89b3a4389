// SPDX-License-Identifier: MIT
#include "experiment/report/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace seqloop::experiment {
namespace {

double real(std::uint64_t count) { return static_cast<double>(count); }

std::string with_commas(double value) {
  const double size = std::abs(value);
  std::string text =
      fmt::format("{:.{}f}", value, size < 100.0 && size != std::floor(size) ? 1 : 0);
  const std::size_t digits_from = value < 0.0 ? 1 : 0;
  for (std::size_t at = std::min(text.find('.'), text.size()); at > digits_from + 3;) {
    text.insert(at -= 3, ",");
  }
  return text;
}

/// Three digits that count, and never an exponent for what can be timed.
std::string three_digits(double value) {
  if (value == 0.0 || value >= 100.0) return with_commas(value);
  const int decimals = value >= 10.0 ? 1 : value >= 1.0 ? 2 : 3;
  return fmt::format("{:.{}f}", value, decimals);
}

/// `.800`, as the literature writes shares.
std::string without_zero(std::string text) {
  if (text.starts_with("0.")) text.erase(0, 1);
  return text;
}

}  // namespace

std::span<const Column> number_columns() {
  using enum Unit;
  using enum Better;
  static const std::array columns{
      Column{"places", "places", count, neither, [](const Result& r) { return real(r.places); }},
      Column{"queries", "queries", count, neither, [](const Result& r) { return real(r.queries); }},
      Column{"frames", "frames", count, neither, [](const Result& r) { return real(r.frames); }},
      Column{"descriptor_size", "descriptor size", count, neither,
             [](const Result& r) { return real(r.descriptor_size); }},
      Column{"answered", "answered", count, neither,
             [](const Result& r) { return real(r.measures.answered); }},
      Column{"correct", "correct", count, more,
             [](const Result& r) { return real(r.measures.correct); }},
      Column{"unknown", "not judged", count, neither,
             [](const Result& r) { return real(r.measures.unknown); }},
      Column{"precision", "precision", share, more,
             [](const Result& r) { return r.measures.precision; }},
      Column{"recall", "recall", share, more, [](const Result& r) { return r.measures.recall; }},
      Column{"recall_at_100_precision", "R@100P", share, more,
             [](const Result& r) { return r.measures.recall_at_100_precision; }},
      Column{"area_under_curve", "area", share, more,
             [](const Result& r) { return r.measures.area_under_curve; }},
      Column{"accepted", "accepted", count, neither,
             [](const Result& r) {
               return r.measures.accepted ? real(*r.measures.accepted) : std::nan("");
             }},
      Column{"accepted_precision", "accepted: precision", share, more,
             [](const Result& r) { return r.measures.accepted_precision; }},
      Column{"accepted_recall", "accepted: recall", share, more,
             [](const Result& r) { return r.measures.accepted_recall; }},
      Column{"expected_calibration_error", "calibration error", share, less,
             [](const Result& r) { return expected_calibration_error(r.measures.reliability); }},
      Column{"distances", "distances/frame", count, less,
             [](const Result& r) { return r.distances; }},
      Column{"most_distances", "most distances", count, less,
             [](const Result& r) { return real(r.most_distances); }},
      Column{"candidates", "candidates/frame", count, less,
             [](const Result& r) { return r.candidates; }},
      Column{"seconds", "matching, s", seconds, less, [](const Result& r) { return r.seconds; }},
      Column{"speed_up", "speed-up", times, more, [](const Result& r) { return r.speed_up; }}};
  return columns;
}

Column column_named(const std::string& name) {
  const auto found = std::ranges::find(number_columns(), name, &Column::name);
  return found != number_columns().end() ? *found : Column{name, name};
}

std::string shown(Unit unit, double value) {
  if (std::isnan(value)) return "–";
  switch (unit) {
    case Unit::count:
      return with_commas(value);
    case Unit::share:
      return without_zero(fmt::format("{:.3f}", value));
    case Unit::seconds:
      return three_digits(value);
    case Unit::times:
      return fmt::format("×{:.{}f}", value, value >= 100.0 ? 0 : 1);
    case Unit::plain:
      break;
  }
  return fmt::format("{:g}", value);
}

}  // namespace seqloop::experiment
