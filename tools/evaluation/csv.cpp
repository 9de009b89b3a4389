// SPDX-License-Identifier: MIT
#include "evaluation/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

#include "evaluation/line_faults.hpp"
#include "files/text_file.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void trim(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
}

/// Takes a cell in quotes from the front of a line; a quote within it is there twice. None where it
/// does not end.
std::optional<std::string> take_quoted(std::string_view& line) {
  std::string cell;
  for (std::size_t at = 1; at < line.size(); ++at) {
    if (line[at] == '"' && (at + 1 == line.size() || line[at + 1] != '"')) {
      line.remove_prefix(at + 1);
      return cell;
    }
    if (line[at] == '"') ++at;
    cell += line[at];
  }
  return std::nullopt;
}

/// @param where for messages. Throws SetupError: a cell in quotes that does not end with them.
std::vector<std::string> cells(std::string_view line, const std::string& where) {
  std::vector<std::string> found;
  while (true) {
    trim(line);
    std::optional<std::string> quoted;
    if (line.starts_with('"')) {
      quoted = take_quoted(line);
      trim(line);
      if (!quoted || !(line.empty() || line.front() == ',')) {
        throw SetupError({where, "a cell in quotes does not end with one",
                          "close it, and write a quote within it twice"});
      }
    }
    const std::size_t end = std::min(line.find(','), line.size());
    std::string_view cell = line.substr(0, end);
    trim(cell);
    found.push_back(quoted ? *quoted : std::string(cell));
    if (end == line.size()) return found;
    line.remove_prefix(end + 1);
  }
}

template <class Number>
std::errc parse(const std::string& cell, Number& value) {
  const char* end = cell.data() + cell.size();
  const auto result = std::from_chars(cell.data(), end, value);
  return result.ptr == end ? result.ec : std::errc::invalid_argument;
}

/// Names of columns are none.
bool is_number(const std::string& cell) {
  double value = 0.0;
  return cell.empty() || parse(cell, value) == std::errc();
}

}  // namespace

CsvTable::CsvTable(std::string_view text, std::string name) : name_(std::move(name)) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    const std::string where = name_ + ":" + std::to_string(number);
    if (header_.empty()) {
      take_header(line, where);
      continue;
    }
    line_numbers_.push_back(number);
    lines_.emplace_back();
    try {
      std::vector<std::string> found = cells(line, where);
      if (found.size() != header_.size()) {
        throw SetupError(
            {where,
             fmt::format("{} under a header of {}", counted(found.size(), "cell"), header_.size()),
             "write a cell for each column"});
      }
      lines_.back() = std::move(found);
    } catch (const SetupError& error) {
      wrong_[lines_.size() - 1] = error.faults();
    }
  }
  if (header_.empty()) throw SetupError({name_, "empty: not even a header line"});
}

void CsvTable::take_header(std::string_view line, const std::string& where) {
  for (const auto& [separator, shown] : {std::pair{';', "';'"}, {'\t', "tabs"}}) {
    if (line.find(',') < line.size() || line.find(separator) == line.npos) continue;
    throw SetupError({name_, "its cells are separated by " + std::string(shown),
                      "write commas between them, and decimal points in numbers"});
  }
  header_ = cells(line, where);
  if (std::ranges::all_of(header_, is_number)) {
    throw SetupError({where, "has numbers, and not the names of columns",
                      "write a line with the names before it, such as query,reference"});
  }
  Faults faults;
  for (auto cell = header_.begin(); cell != header_.end(); ++cell) {
    // Spreadsheets leave columns behind that have neither a name nor cells.
    if (cell->empty() || std::find(header_.begin(), cell, *cell) == cell) continue;
    faults.push_back({name_, "the column '" + *cell + "' is there twice", "remove one of them"});
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
}

CsvTable CsvTable::read(const std::filesystem::path& file) {
  return {files::read_text(file), file.string()};
}

std::string CsvTable::where(std::size_t row) const {
  return name_ + ":" + std::to_string(line_numbers_[row]);
}

std::optional<std::size_t> CsvTable::find(std::string_view header) const noexcept {
  const auto found = std::ranges::find(header_, header);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

std::size_t CsvTable::column(std::string_view header) const {
  if (const std::optional<std::size_t> found = find(header)) return *found;
  constexpr std::size_t room = 100;
  std::string remedy = fmt::format("its columns are {}", fmt::join(header_, ", "));
  if (remedy.size() > room) remedy = "is this the right file?";
  throw SetupError(
      {name_, "no column '" + std::string(header) + "' in its header line", std::move(remedy)});
}

std::vector<std::size_t> CsvTable::columns(const std::vector<std::string>& headers) const {
  std::vector<std::size_t> found;
  Faults faults;
  for (const std::string& header : headers) {
    try {
      found.push_back(column(header));
    } catch (const SetupError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
  return found;
}

void CsvTable::for_each_row(const std::function<void(CsvRow&)>& read) const {
  LineFaults faults(name_);
  for (std::size_t row = 0; row < rows(); ++row) {
    faults.collect([&] {
      if (const auto wrong = wrong_.find(row); wrong != wrong_.end())
        throw SetupError(wrong->second);
      CsvRow cells_of_it(*this, row);
      read(cells_of_it);
      if (!cells_of_it.faults().empty()) throw SetupError(cells_of_it.faults());
    });
  }
  faults.refuse();
}

template <class Cell, class Value>
Value CsvRow::read(Cell cell, Value otherwise) {
  try {
    return cell();
  } catch (const SetupError& error) {
    faults_.insert(faults_.end(), error.faults().begin(), error.faults().end());
    return otherwise;
  }
}

std::uint64_t CsvRow::whole(std::size_t column) {
  return read([&] { return table_->whole(row_, column); }, std::uint64_t{0});
}

std::int64_t CsvRow::integer(std::size_t column) {
  return read([&] { return table_->integer(row_, column); }, std::int64_t{0});
}

double CsvRow::number(std::size_t column) {
  return read([&] { return table_->number(row_, column); }, nan);
}

double CsvRow::number_within(std::size_t column, double least, double most) {
  return read([&] { return table_->number_within(row_, column, least, most); }, nan);
}

bool CsvRow::flag(std::size_t column) {
  return read([&] { return table_->flag(row_, column); }, false);
}

bool CsvRow::empty(std::size_t column) const { return table_->empty(row_, column); }

std::string CsvRow::where() const { return table_->where(row_); }

std::uint64_t CsvTable::whole(std::size_t row, std::size_t column) const {
  constexpr std::uint64_t most = std::uint64_t{1} << 62U;
  std::uint64_t value = 0;
  if (parse(lines_[row][column], value) != std::errc() || value > most) {
    refuse(row, column, "a whole number up to 2^62");
  }
  return value;
}

std::int64_t CsvTable::integer(std::size_t row, std::size_t column) const {
  std::int64_t value = 0;
  if (parse(lines_[row][column], value) != std::errc()) refuse(row, column, "a whole number");
  return value;
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  double value = 0.0;
  const std::errc error = parse(lines_[row][column], value);
  if (error == std::errc::result_out_of_range) {
    refuse(row, column, "a number of a size that a double can have");
  }
  if (error != std::errc()) refuse(row, column, "a number");
  return value;
}

double CsvTable::number_within(std::size_t row, std::size_t column, double least,
                               double most) const {
  const double value = number(row, column);
  if (!(value >= least && value <= most)) {
    refuse(row, column, fmt::format("a number from {} to {}", least, most));
  }
  return value;
}

bool CsvTable::flag(std::size_t row, std::size_t column) const {
  const std::string& cell = lines_[row][column];
  if (cell != "0" && cell != "1") refuse(row, column, "0 or 1");
  return cell == "1";
}

void CsvTable::refuse(std::size_t row, std::size_t column, std::string_view wanted) const {
  throw SetupError({where(row), "'" + lines_[row][column] + "' under '" + header_[column] +
                                    "' is not " + std::string(wanted)});
}

}  // namespace seqloop::evaluation
