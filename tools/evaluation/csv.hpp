// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {

class CsvTable;

/// A row that is read to its end: of a cell that is no such number the reader has 0 or NaN, and the
/// fault is kept beside those of the other cells.
class CsvRow {
 public:
  CsvRow(const CsvTable& table, std::size_t row) : table_(&table), row_(row) {}

  /// As those of the table; none throws.
  [[nodiscard]] std::uint64_t whole(std::size_t column);
  [[nodiscard]] std::int64_t integer(std::size_t column);
  [[nodiscard]] double number(std::size_t column);
  [[nodiscard]] double number_within(std::size_t column, double least, double most);
  [[nodiscard]] bool flag(std::size_t column);
  [[nodiscard]] bool empty(std::size_t column) const;

  [[nodiscard]] std::string where() const;
  [[nodiscard]] const Faults& faults() const noexcept { return faults_; }

 private:
  template <class Cell, class Value>
  Value read(Cell cell, Value otherwise);

  const CsvTable* table_;
  std::size_t row_;
  Faults faults_;
};

/// A file of comma-separated numbers under a header line; cells may stand in quotes.
class CsvTable {
 public:
  /// @param name the file, for messages. Throws SetupError: no header, one with a column twice or
  /// without commas. Lines with too few or too many cells are rows, and told by `for_each_row`.
  CsvTable(std::string_view text, std::string name);

  /// Throws SetupError when the file cannot be read, and as above.
  static CsvTable read(const std::filesystem::path& file);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::size_t rows() const noexcept { return lines_.size(); }

  /// @return `NAME:LINE`, for messages
  [[nodiscard]] std::string where(std::size_t row) const;

  /// @return index of the column with this header; none where there is no such column
  [[nodiscard]] std::optional<std::size_t> find(std::string_view header) const noexcept;
  [[nodiscard]] bool has(std::string_view header) const noexcept {
    return find(header).has_value();
  }

  /// The same. Throws SetupError: there is none.
  [[nodiscard]] std::size_t column(std::string_view header) const;

  /// Likewise, of several. Throws SetupError with all that are missing.
  [[nodiscard]] std::vector<std::size_t> columns(const std::vector<std::string>& headers) const;

  /// Calls `read` for each row that has as many cells as the header; all that reads cells is called
  /// from there. Throws SetupError with a handful of the other rows, of what `read` throws, and of
  /// the row's cells that are no such number.
  void for_each_row(const std::function<void(CsvRow&)>& read) const;

  /// Throw SetupError, with the line, for a cell that is no such number.
  [[nodiscard]] std::uint64_t whole(std::size_t row, std::size_t column) const;
  [[nodiscard]] std::int64_t integer(std::size_t row, std::size_t column) const;  ///< below 0, too
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;  ///< nan and inf too
  [[nodiscard]] double number_within(std::size_t row, std::size_t column, double least,
                                     double most) const;
  [[nodiscard]] bool flag(std::size_t row, std::size_t column) const;  ///< 0 or 1
  [[nodiscard]] bool empty(std::size_t row, std::size_t column) const {
    return lines_[row][column].empty();
  }

 private:
  void take_header(std::string_view line, const std::string& where);
  [[noreturn]] void refuse(std::size_t row, std::size_t column, std::string_view wanted) const;

  std::string name_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> lines_;
  std::vector<std::size_t> line_numbers_;
  std::map<std::size_t, Faults> wrong_;  // by row, which has no cells
};

}  // namespace seqloop::evaluation
