// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::evaluation {

/// An answer, and the number that a precision-recall curve sweeps: smaller is more certain.
struct Answer {
  std::uint64_t query;
  std::uint64_t match;
  double uncertainty;  ///< NaN: the least certain of all
};

/// Which of a match list's numbers the curve sweeps.
enum class ThresholdOn : std::uint8_t { uniqueness, score };

/// Takes a match list apart: the CSV table of `match` or the JSON lines of `run`, which begin with
/// a brace. Of a JSON line, the answers are the objects under `answers` where it has that key, else
/// the line itself; one whose `frame` or `match` is null is none, and a number that is null was
/// undefined or infinite.
/// @param name the file, for messages
/// Throws SetupError with the line: what is no number, a column or a key that is missing, a query
/// that is answered twice.
[[nodiscard]] std::vector<Answer> parse_answers(std::string_view text, const std::string& name,
                                                ThresholdOn threshold_on);

/// Reads a match list from a file of up to 4 GiB. Throws SetupError, also where it cannot be read.
[[nodiscard]] std::vector<Answer> read_answers(const std::filesystem::path& file,
                                               ThresholdOn threshold_on);

}  // namespace seqloop::evaluation
