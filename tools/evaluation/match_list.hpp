// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {

/// An answer, and what it says of itself.
struct Answer {
  std::uint64_t query;
  std::uint64_t match;
  /// What a precision-recall curve sweeps: smaller is more certain, NaN the least certain of all.
  double uncertainty;
  /// That the match is right, 0 .. 1; NaN: not said.
  double probability = std::numeric_limits<double>::quiet_NaN();
  std::optional<bool> accepted = {};  ///< whether the program stands by it; none: not said
};

/// Answers of a match list, each to another query.
class Answers {
 public:
  /// @return false where its query has an answer already. Work: log N.
  [[nodiscard]] bool add(const Answer& answer);

  /// What is to be told then. @param where the answer stands
  [[nodiscard]] static Fault answered_twice(std::string where, const Answer& answer);

  [[nodiscard]] std::vector<Answer> take() { return std::move(answers_); }

 private:
  std::vector<Answer> answers_;
  std::set<std::uint64_t> queries_;
};

/// Which of a match list's numbers the curve sweeps. A larger probability is more certain, a
/// smaller uniqueness or score.
enum class ThresholdOn : std::uint8_t { uniqueness, score, probability };

/// Of the column, the key and the setting.
[[nodiscard]] std::string name_of(ThresholdOn threshold_on);

/// @param value of the number that is swept
/// @return `Answer::uncertainty`
[[nodiscard]] double uncertainty(ThresholdOn threshold_on, double value) noexcept;

/// Takes a match list apart: the CSV table of `match` or the JSON lines of `run`, which begin with
/// a brace. Of a JSON line, the answers are the objects under `answers` where it has that key, else
/// the line itself; one whose `frame` or `match` is null is none, and a number that is null was
/// undefined or infinite. The columns `probability` and `accepted` may be missing, the keys
/// `probability` and `status` likewise; an answer of status `match` is accepted.
/// @param name the file, for messages
/// Throws SetupError with the line: what is no number, no probability, no acceptance, no status; a
/// column or a key that is missing; a query that is answered twice.
[[nodiscard]] std::vector<Answer> parse_answers(std::string_view text, const std::string& name,
                                                ThresholdOn threshold_on);

/// Reads a match list from a file of up to 4 GiB. Throws SetupError, also where it cannot be read.
[[nodiscard]] std::vector<Answer> read_answers(const std::filesystem::path& file,
                                               ThresholdOn threshold_on);

}  // namespace seqloop::evaluation
