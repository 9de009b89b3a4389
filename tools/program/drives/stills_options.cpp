// SPDX-License-Identifier: MIT
#include "program/drives/stills_options.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "evaluation/csv.hpp"

namespace seqloop::program {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.push_back(text.substr(0, end));
    if (end == text.size()) return parts;
    text.remove_prefix(end + 1);
  }
}

double parse_moment(std::string_view text) {
  constexpr std::size_t most_parts = 3;
  const std::vector<double> parts = parse_numbers(text, ':');
  double seconds = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool fits = parts[i] >= 0.0 && (i == 0 || parts[i] < 60.0);
    if (!fits || parts.size() > most_parts) {
      throw std::invalid_argument("'" + std::string(text) +
                                  "' is no time like 75, 1:15 or 0:01:15");
    }
    seconds = seconds * 60.0 + parts[i];
  }
  return seconds;
}

Interval parse_interval(std::string_view text) {
  const std::vector<std::string_view> ends = split(text, '-');
  if (ends.size() != 2) {
    throw std::invalid_argument("'" + std::string(text) + "' is not FROM-TO");
  }
  return {parse_moment(ends[0]), parse_moment(ends[1])};
}

std::vector<Interval> read_intervals(const std::filesystem::path& file) {
  const auto table = evaluation::CsvTable::read(file);
  const std::vector<std::size_t> columns = table.columns({"from_s", "to_s"});
  std::vector<Interval> intervals;
  table.for_each_row([&](evaluation::CsvRow& row) {
    intervals.push_back({row.number(columns[0]), row.number(columns[1])});
  });
  return intervals;
}

}  // namespace

Crop parse_crop(std::string_view text) {
  const std::vector<std::string_view> parts = split(text, '+');
  if (parts.size() != 1 && parts.size() != 3) {
    throw std::invalid_argument("'" + std::string(text) + "' is not WIDTHxHEIGHT+X+Y");
  }
  const auto [width, height] = parse_size(parts[0]);
  if (parts.size() == 1) return {width, height};
  return {width, height, parse_pixels(parts[1], 0), parse_pixels(parts[2], 0)};
}

std::vector<Interval> parse_intervals(const std::string& text) {
  std::error_code error;
  if (std::filesystem::exists(text, error)) return read_intervals(text);
  try {
    std::vector<Interval> intervals;
    for (const std::string_view part : split(text, ',')) intervals.push_back(parse_interval(part));
    return intervals;
  } catch (const std::invalid_argument& why) {
    throw std::invalid_argument("'" + text + "' is neither a file nor a list (" + why.what() + ")");
  }
}

void add_stills_options(OptionTable& options, StillsSettings& settings) {
  options.number("every-s", settings.every_s,
                 "seconds from one still to the next, by the source's clock [every frame]");
  options.number("from-s", settings.from_s, "seconds at which to begin [0]");
  options.number("to-s", settings.to_s, "seconds before which to end [the end]");
  options.add({"leave-out", ValueKind::text,
               "tunnels and halts: a CSV file from_s,to_s, or a list like 90-120,1:02:10-1:03:00",
               [&settings](std::string_view value) {
                 settings.leave_out = parse_intervals(std::string(value));
               }});
  options.add({"size", ValueKind::size, "WxH to resize to [the picture's own]",
               [&settings](std::string_view value) {
                 std::tie(settings.width, settings.height) = parse_size(value);
               }});
  options.add({"crop", ValueKind::text, "part to keep, after resizing: WxH+X+Y [everything]",
               [&settings](std::string_view value) { settings.crop = parse_crop(value); }});
  options.flag("gray", settings.gray, "grey pictures");
}

}  // namespace seqloop::program
