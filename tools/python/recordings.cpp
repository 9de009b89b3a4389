// SPDX-License-Identifier: MIT
#include "python/recordings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "evaluation/line_faults.hpp"
#include "evaluation/measures.hpp"
#include "program/drives/match_drive.hpp"
#include "program/drives/unit_rows.hpp"
#include "program/options/matcher_settings.hpp"
#include "program/options/truth_settings.hpp"
#include "program/options/verb.hpp"
#include "python/interpreter_lock.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

/// Throws SetupError: some numbers are none as float32, which would make them infinite.
void check_range(const Array& drive, const std::string& name) {
  if (static_cast<std::size_t>(drive.itemsize()) <= sizeof(float)) return;
  constexpr double most_float = std::numeric_limits<float>::max();
  const auto least = drive.attr("min")().cast<double>();
  const auto most = drive.attr("max")().cast<double>();
  const double largest = std::max(-least, most);
  if (!(largest > most_float) || !std::isfinite(largest)) return;
  throw SetupError(
      {name, fmt::format("it holds {}, which is beyond float32", largest == most ? most : least),
       "give smaller values"});
}

/// The columns of the program's match list.
py::dict columns_of(const program::MatchedDrive& matched) {
  const std::size_t rows = matched.frames.size();
  const auto shape = static_cast<py::ssize_t>(rows);
  const auto column = [&](const auto& value_of) {
    using Value = std::decay_t<decltype(value_of(matched.frames.front()))>;
    py::array_t<Value> values(shape);
    auto into = values.template mutable_unchecked<1>();
    for (std::size_t i = 0; i < rows; ++i) {
      into(static_cast<py::ssize_t>(i)) = value_of(matched.frames[i]);
    }
    return values;
  };
  using Frame = program::MatchedFrame;
  const auto whole = [](std::uint64_t value) { return static_cast<std::int64_t>(value); };
  using namespace py::literals;
  return py::dict(
      "query"_a = column([&](const Frame& frame) { return whole(frame.answer.frame); }),
      "match"_a = column([&](const Frame& frame) { return whole(frame.answer.match->frame()); }),
      "score"_a = column([](const Frame& frame) { return frame.answer.match->score; }),
      "uniqueness"_a = column([](const Frame& frame) { return frame.answer.match->uniqueness; }),
      "velocity"_a = column([](const Frame& frame) { return frame.answer.match->velocity; }),
      "head"_a = column([&](const Frame& frame) { return whole(frame.answer.match->head); }),
      "candidates"_a = column([&](const Frame& frame) { return whole(frame.candidates); }),
      "k"_a = column([&](const Frame& frame) { return whole(frame.k); }),
      "distances"_a = column([&](const Frame& frame) { return whole(frame.distances); }),
      "probability"_a = column([](const Frame& frame) { return frame.answer.probability; }),
      "accepted"_a = column([](const Frame& frame) { return frame.answer.gate == Gate::match; }));
}

py::dict match(const std::optional<Given>& reference, const std::optional<Given>& query,
               const py::kwargs& settings) {
  Faults faults;
  std::optional<Array> mapped;
  std::optional<Array> driven;
  if (reference) program::collect(faults, [&] { mapped = drive_of(*reference, "reference"); });
  if (query) {
    program::collect(faults, [&] { driven = drive_of(*query, "query"); });
  } else {
    faults.push_back({"query", "not given", "match(None, query) closes loops within one drive"});
  }
  const std::optional<Array>& places_of = reference ? mapped : driven;
  const MatcherConfig config =
      config_of(reference ? Use::localise : Use::close_loops,
                places_of ? static_cast<std::size_t>(places_of->shape(0)) : 0, settings, faults);
  std::optional<files::Matrix> places;
  std::optional<files::Matrix> frames;
  if (mapped) {
    program::collect(faults, [&] { places = matrix(*mapped, "reference", config.difference); });
  }
  if (driven) {
    program::collect(faults, [&] { frames = matrix(*driven, "query", config.difference); });
  }
  if (frames && (!reference || places)) {
    program::check_match(faults, config, places ? &*places : nullptr, *frames);
  }
  program::refuse(std::move(faults));
  program::MatchedDrive matched;
  {
    const Unlocked unlocked;
    matched =
        program::match_drive(config, std::move(places), *frames, {nullptr, look_for_interruption});
  }
  return columns_of(matched);
}

/// A column of a match list. @param kinds of NumPy's types that fit   @param wanted in words
template <class Value>
py::array_t<Value> column_of(const py::object& matches, const char* name, std::string_view kinds,
                             const char* wanted, evaluation::LineFaults& faults) {
  const py::object column = matches.attr(name);
  const Array given = Array::ensure(column);
  const bool fits = given && given.ndim() == 1 && !is_masked(column) &&
                    kinds.find(given.dtype().kind()) != std::string_view::npos;
  // Nothing has any type.
  if (fits || (given && given.ndim() == 1 && given.size() == 0)) return py::array_t<Value>(given);
  const bool is_array = given && given.ndim() > 0;
  const std::string is = is_array ? py::str(given.dtype()).cast<std::string>() + " of shape " +
                                        py::str(given.attr("shape")).cast<std::string>() +
                                        (is_masked(column) ? ", and partly masked" : "")
                                  : type_name(column);
  faults.add({"matches." + std::string(name), "it is " + is, std::string("give ") + wanted});
  return {};
}

/// Throws SetupError with all that `seqloop eval` would refuse in a match list, too.
std::vector<evaluation::Answer> answers_of(const py::object& matches,
                                           const std::string& threshold_on,
                                           evaluation::ThresholdOn on) {
  for (const char* const name :
       {"query", "match", threshold_on.c_str(), "probability", "accepted"}) {
    if (py::hasattr(matches, name)) continue;
    throw SetupError({"matches", "its type is " + type_name(matches) + ", not seqloop.Matches",
                      "give what match returned; `seqloop eval --matches` reads match lists"});
  }
  constexpr auto whole = "whole numbers, [M]";
  constexpr auto most_number = std::int64_t{1} << 62U;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr auto numbers = "numbers, [M]";
  evaluation::LineFaults faults("matches");
  const auto query = column_of<std::int64_t>(matches, "query", "iu", whole, faults);
  const auto match = column_of<std::int64_t>(matches, "match", "iu", whole, faults);
  const auto threshold = column_of<double>(matches, threshold_on.c_str(), "fiu", numbers, faults);
  std::optional<py::array_t<double>> probability;
  if (on == evaluation::ThresholdOn::probability) {
    probability = threshold;
  } else if (!matches.attr("probability").is_none()) {
    probability = column_of<double>(matches, "probability", "fiu", "numbers, [M], or None", faults);
  }
  std::optional<py::array_t<bool>> accepted;
  if (!matches.attr("accepted").is_none()) {
    accepted = column_of<bool>(matches, "accepted", "b", "booleans, [M], or None", faults);
  }
  faults.refuse();
  const auto check_length = [&](const char* name, py::ssize_t length) {
    if (length == query.size()) return;
    faults.add({"matches." + std::string(name),
                fmt::format("it has {} and query has {}",
                            counted(static_cast<std::uint64_t>(length), "value"),
                            static_cast<std::uint64_t>(query.size())),
                "give one for each query"});
  };
  check_length("match", match.size());
  if (on != evaluation::ThresholdOn::probability) {
    check_length(threshold_on.c_str(), threshold.size());
  }
  if (probability) check_length("probability", probability->size());
  if (accepted) check_length("accepted", accepted->size());
  faults.refuse();
  evaluation::Answers answers;
  for (py::ssize_t i = 0; i < query.size(); ++i) {
    const auto where = [i] { return fmt::format("matches, row {}", i); };
    const double said = probability ? probability->at(i) : nan;
    const auto [least, most] = std::minmax(query.at(i), match.at(i));
    if (least < 0 || most > most_number) {
      faults.add({where(), "a frame or a place is below 0, or above 2^62", "count them from 0"});
    }
    if (said < 0.0 || said > 1.0) {
      faults.add({where(), fmt::format("its probability is {}", said), "give 0 to 1, or NaN"});
    }
    evaluation::Answer answer{static_cast<std::uint64_t>(query.at(i)),
                              static_cast<std::uint64_t>(match.at(i)),
                              evaluation::uncertainty(on, threshold.at(i)), said};
    if (accepted) answer.accepted = accepted->at(i);
    if (!answers.add(answer)) faults.add(evaluation::Answers::answered_twice(where(), answer));
  }
  faults.refuse();
  return answers.take();
}

/// Right answers as a CSV file has them. Throws SetupError.
std::string table_of(const Array& truth) {
  const bool whole = truth.dtype().kind() == 'i' || truth.dtype().kind() == 'u';
  const bool fits = truth.ndim() == 2 && (truth.shape(1) == 2 || truth.shape(1) == 3);
  if (!whole || !fits || truth.attr("min")(py::arg("initial") = 0).cast<std::int64_t>() < 0) {
    throw SetupError({"truth",
                      "it is " + py::str(truth.dtype()).cast<std::string>() + " of shape " +
                          py::str(truth.attr("shape")).cast<std::string>(),
                      "give integers of 0 or more, [T, 2] or [T, 3]: query, reference, tolerance"});
  }
  if (py::int_(truth.attr("max")(py::arg("initial") = 0)) >
      py::int_(std::numeric_limits<std::int64_t>::max())) {
    throw SetupError({"truth", "it holds numbers of 2^63 or more", "give numbers of frames"});
  }
  const py::array_t<std::int64_t> rows(truth);
  std::string table = rows.shape(1) == 3 ? "query,reference,tolerance\n" : "query,reference\n";
  for (py::ssize_t row = 0; row < rows.shape(0); ++row) {
    for (py::ssize_t column = 0; column < rows.shape(1); ++column) {
      table += (column > 0 ? "," : "") + std::to_string(rows.at(row, column));
    }
    table += '\n';
  }
  return table;
}

/// @param truth [T, 2] query, reference or [T, 3] with a tolerance; none: as the settings say
/// @param given also `threshold_on` and `frames`
py::dict evaluate(const py::object& matches, const std::optional<Array>& truth,
                  const py::kwargs& given) {
  Faults faults;
  program::TruthSettings settings;
  std::string threshold_on = "uniqueness";
  std::size_t frames = 0;
  program::OptionTable options;
  add_truth_options(options, settings);
  options.text("threshold-on", threshold_on, "give uniqueness, score or probability");
  options.count("frames", frames, "give how many queries have a truth, or leave it out");
  const std::string listed = "help(seqloop.evaluate)";
  for (Fault& fault : set_options(options, given, listed)) faults.push_back(std::move(fault));
  std::vector<evaluation::Answer> answers;
  program::collect(faults, [&] {
    evaluation::ThresholdOn on{};
    try {
      on = program::parse_threshold(threshold_on);
    } catch (const std::invalid_argument& why) {
      faults.push_back({"threshold_on", why.what()});
      threshold_on = "uniqueness";
    }
    answers = answers_of(matches, threshold_on, on);
  });
  evaluation::Truth known;
  if (truth) {
    settings.file = "truth";  // any name: it is by a list, not by identity
    if (!settings.reference_positions.empty() || !settings.query_positions.empty()) {
      faults.push_back({"truth", "positions are given too", "leave one of them out"});
    } else if (settings.radius_m) {
      faults.push_back({"radius", "it goes with positions, and none are given",
                        "reference_positions R.csv, query_positions Q.csv"});
    }
    program::collect(faults, [&] {
      known = evaluation::Truth::from_csv(evaluation::CsvTable(table_of(*truth), "truth"),
                                          settings.unlisted.value_or(evaluation::Unlisted::wrong));
    });
  } else {
    known = read_truth(settings, faults);
  }
  const program::JudgedBy judge = judge_by(settings, std::move(known), frames, answers, faults);
  program::refuse(std::move(faults));
  const evaluation::Measures measures =
      measure(std::move(answers), judge.truth, tolerance(settings), judge.frames);
  std::vector<double> curve;
  for (const evaluation::CurvePoint& point : measures.curve) {
    curve.push_back(point.recall);
    curve.push_back(point.precision);
  }
  using namespace py::literals;
  return py::dict(
      "frames"_a = judge.frames, "answered"_a = measures.answered, "correct"_a = measures.correct,
      "unknown"_a = measures.unknown, "precision"_a = measures.precision,
      "recall"_a = measures.recall, "recall_at_100_precision"_a = measures.recall_at_100_precision,
      "area_under_curve"_a = measures.area_under_curve, "accepted"_a = measures.accepted,
      "accepted_precision"_a = measures.accepted_precision,
      "accepted_recall"_a = measures.accepted_recall,
      "expected_calibration_error"_a = expected_calibration_error(measures.reliability),
      "curve"_a =
          as_array(curve, {static_cast<py::ssize_t>(measures.curve.size()), py::ssize_t{2}}));
}

}  // namespace

Array drive_of(const Given& given, const std::string& name) {
  Array array = descriptors_of(given, name);
  Faults faults;
  if (array.ndim() != 2 || array.size() == 0) {
    faults.push_back({name, "its shape is " + py::str(array.attr("shape")).cast<std::string>(),
                      "give [N, D]: a row for each frame"});
  }
  if (array.dtype().kind() != 'f') {
    faults.push_back({name, "it is " + py::str(array.dtype()).cast<std::string>(),
                      "give floating-point descriptors"});
  }
  program::refuse(std::move(faults));
  check_range(array, name);
  return array;
}

files::Matrix matrix(const Array& drive, const std::string& name, Difference difference) {
  const py::array_t<float, py::array::c_style | py::array::forcecast> plain(drive);
  files::Matrix copy{static_cast<std::size_t>(plain.shape(0)),
                     static_cast<std::size_t>(plain.shape(1)),
                     {plain.data(), plain.data() + plain.size()}};
  check_finite(copy, name);
  if (difference == Difference::euclidean) program::normalise_rows(copy);
  return copy;
}

MatcherConfig config_of(Use use, std::size_t places, const py::kwargs& settings, Faults& faults) {
  program::MatcherSettings matcher;
  program::OptionTable options;
  program::add_matcher_options(options, matcher);
  for (Fault& fault : set_options(options, settings)) faults.push_back(std::move(fault));
  MatcherConfig config = resolve(matcher, use, faults);
  suit_slice(config, matcher, places);
  return config;
}

void add_recordings(py::module_& module) {
  module.def("match", &match, py::arg("reference").none(true), py::arg("query").none(true));
  module.def(
      "drive_faults",
      [](const Given& given, const std::string& name, bool finite) {
        Faults faults;
        program::collect(faults, [&] {
          const Array drive = drive_of(given, name);
          if (finite) static_cast<void>(matrix(drive, name, Difference::mean_absolute));
        });
        return listed(faults);
      },
      py::arg("drive"), py::arg("name"), py::arg("finite"));
  module.def("evaluate", &evaluate, py::arg("matches"), py::arg("pairs").none(true));
  module.def("settings", [] { return described(program::add_matcher_options); });
}

}  // namespace seqloop::python
