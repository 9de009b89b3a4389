// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/measures.hpp"

namespace seqloop::experiment {

/// A setting of a run, as the experiment file writes it.
struct Setting {
  std::string name;
  std::string value;
};

/// What came of one method with one set of parameters on one pair of drives.
struct Result {
  std::string pair;               ///< the pair of drives
  std::string method;             ///< what the experiment file calls it
  std::string descriptor;         ///< likewise
  std::vector<Setting> settings;  ///< everything that the file sets for the method, swept or not
  std::uint64_t places = 0;       ///< rows of the map
  std::uint64_t queries = 0;      ///< frames matched
  std::uint64_t frames = 0;       ///< queries that have a truth
  std::uint64_t descriptor_size = 0;
  evaluation::Measures measures{};
  double distances = 0.0;            ///< descriptor distances a frame, mean
  std::uint64_t most_distances = 0;  ///< of one frame
  double candidates = 0.0;           ///< rows scored, mean over the frames that had any
  double seconds = 0.0;              ///< matching alone, all frames
  bool alone = false;                ///< no other run was matched meanwhile
  std::string made_by{};             ///< program and machine
  std::string matrix{};              ///< fingerprint of its matrix's picture; empty: none
  bool is_copy = false;              ///< of another result, under another method's name
  /// Seconds of the exhaustive search over the same descriptors with the same sequence length, by
  /// `seconds`; NaN where it was not run, or where runs shared a machine.
  double speed_up = std::numeric_limits<double>::quiet_NaN();
};

/// What a figure or a table shows: the results for which each of these settings (or `pair`,
/// `method`, `descriptor`) has one of the values.
struct Filter {
  std::string name;
  std::vector<std::string> values;
};

enum class FigureKind : std::uint8_t {
  precision_recall,  ///< precision over recall, a line a result
  reliability,       ///< share right over the probability said, a line a group of results
  measure            ///< one measure over a setting, a line a group of results
};

/// A figure: small multiples, one panel a value of `panel`, one line a value of `line`.
struct Figure {
  std::string title;
  std::string text;  ///< what there is to see; may be empty
  FigureKind kind = FigureKind::precision_recall;
  std::string panel;  ///< a setting's name, or `pair`, `method`, `descriptor`; empty: one panel
  std::vector<std::string> line;  ///< likewise; together they name a line
  std::string x;                  ///< FigureKind::measure: the setting along the axis
  std::string y;                  ///< FigureKind::measure: a column of results.csv
  std::vector<Filter> where;
};

/// A table: a row a combination of `rows`, a column a combination of `columns`; in each cell the
/// measures named by `values` (columns of results.csv).
struct Table {
  std::string title;
  std::string text;
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<std::string> values;
  std::vector<Filter> where;
};

/// A difference matrix as a picture, references downwards, queries to the right.
struct MatrixPicture {
  std::string title;
  std::string text;
  std::vector<std::uint8_t> png;  ///< the file's bytes
};

/// Everything that the report shows.
struct Report {
  std::string title;
  std::string text;  ///< what the experiment reproduces; paragraphs between blank lines
  std::vector<Setting> conditions;  ///< machine, compiler, commit, command, date …, in this order
  std::vector<Result> results;
  std::vector<Figure> figures;
  std::vector<Table> tables;
  std::vector<MatrixPicture> matrices;
  std::vector<Setting> pairs{};  ///< of each pair: its drives, and which answers are right
};

/// @param name `pair`, `method`, `descriptor`, or a setting's name
/// @return the value that a result has under that name; empty when it has none
[[nodiscard]] std::string value_of(const Result& result, const std::string& name);

/// @param name a column of results.csv that holds a number
/// @return NaN for a name that is none
[[nodiscard]] double number_of(const Result& result, const std::string& name);

}  // namespace seqloop::experiment
