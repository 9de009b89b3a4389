// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "experiment/report/selection.hpp"

namespace seqloop::experiment {

/// Whether the best of every measure is bold: of its column, among the results of one pair.
enum class Best : std::uint8_t { bold, plain };

/// An HTML table in a box of its own, in which it scrolls when it is wide. Several results in one
/// cell stand below each other; many measures under many columns have a row each. A first row name
/// `pair` makes a heading over its rows instead of a column.
/// @param results what the table shows; `table.where`, `title` and `text` are not looked at
/// @param caption HTML, phrasing or paragraphs
[[nodiscard]] std::string table_html(const Chosen& results, const Table& table,
                                     const std::string& caption, Best best);

}  // namespace seqloop::experiment
