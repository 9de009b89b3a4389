// SPDX-License-Identifier: MIT
#include "evaluation/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "files/text_file.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

std::vector<std::string> cells(std::string_view line) {
  std::vector<std::string> found;
  while (true) {
    const std::size_t end = std::min(line.find(','), line.size());
    std::string_view cell = line.substr(0, end);
    while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
    while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
    found.emplace_back(cell);
    if (end == line.size()) return found;
    line.remove_prefix(end + 1);
  }
}

template <class Number>
bool parse(const std::string& cell, Number& value) {
  const char* end = cell.data() + cell.size();
  const auto result = std::from_chars(cell.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

CsvTable::CsvTable(std::string_view text, std::string name) : name_(std::move(name)) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    std::vector<std::string> found = cells(line);
    if (header_.empty()) {
      header_ = std::move(found);
      continue;
    }
    if (found.size() != header_.size()) {
      throw SetupError({name_ + ":" + std::to_string(number), std::to_string(found.size()) +
                                                                  " cells under a header of " +
                                                                  std::to_string(header_.size())});
    }
    lines_.push_back(std::move(found));
    line_numbers_.push_back(number);
  }
  if (header_.empty()) throw SetupError({name_, "empty: not even a header line"});
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
  throw SetupError({name_, "no column '" + std::string(header) + "' in its header line"});
}

std::uint64_t CsvTable::whole(std::size_t row, std::size_t column) const {
  constexpr std::uint64_t most = std::uint64_t{1} << 62U;
  std::uint64_t value = 0;
  if (!parse(lines_[row][column], value) || value > most) {
    refuse(row, column, "a whole number up to 2^62");
  }
  return value;
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  double value = 0.0;
  if (!parse(lines_[row][column], value)) refuse(row, column, "a number");
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
