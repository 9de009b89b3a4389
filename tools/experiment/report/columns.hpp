// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// How the numbers of a column are written for people.
enum class Unit : std::uint8_t { count, share, seconds, times, plain };

/// Which numbers of a column are good ones.
enum class Better : std::uint8_t { neither, more, less };

/// A number that a result has, and a column of results.csv.
struct Column {
  std::string name;   ///< in results.csv
  std::string title;  ///< for people, with its unit
  Unit unit = Unit::plain;
  Better better = Better::neither;
  double (*read)(const Result&) = nullptr;
};

/// The numbers that every result has, in the order of results.csv.
[[nodiscard]] std::span<const Column> number_columns();

/// The column of this name; for any other name, a setting's, one of plain numbers without `read`.
[[nodiscard]] Column column_named(const std::string& name);

/// A number for people: `3,476`, `.800`, `12.3`, `×5.2`; `–` for NaN.
[[nodiscard]] std::string shown(Unit unit, double value);

}  // namespace seqloop::experiment
