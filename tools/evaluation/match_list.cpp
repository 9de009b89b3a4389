// SPDX-License-Identifier: MIT
#include "evaluation/match_list.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "evaluation/csv.hpp"
#include "files/text_file.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

using Json = nlohmann::json;

/// Of the column and the key.
std::string name_of(ThresholdOn threshold_on) {
  return threshold_on == ThresholdOn::uniqueness ? "uniqueness" : "score";
}

std::vector<Answer> from_table(const CsvTable& table, const std::string& swept) {
  const std::size_t query = table.column("query");
  const std::size_t match = table.column("match");
  const std::size_t uncertainty = table.column(swept);
  std::vector<Answer> answers;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    answers.push_back(
        {table.whole(row, query), table.whole(row, match), table.number(row, uncertainty)});
  }
  return answers;
}

/// Answers of `run`'s lines.
class Lines {
 public:
  Lines(std::string name, std::string swept) : name_(std::move(name)), swept_(std::move(swept)) {}

  void take(std::string_view line, std::size_t number) {
    where_ = name_ + ":" + std::to_string(number);
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object()) refuse("is no JSON object");
    const auto several = json.find("answers");
    if (several == json.end()) return add(json);
    if (!several->is_array()) refuse("'answers' is no array");
    for (const Json& answer : *several) {
      if (!answer.is_object()) refuse("'answers' holds what is no JSON object");
      add(answer);
    }
  }

  std::vector<Answer> answers;

 private:
  void add(const Json& answer) {
    const Json& query = at(answer, "frame");
    const Json& match = at(answer, "match");
    const Json& uncertainty = at(answer, swept_);
    if (query.is_null() || match.is_null()) return;
    if (!uncertainty.is_null() && !uncertainty.is_number()) refuse("'" + swept_ + "' is no number");
    answers.push_back({whole(query, "frame"), whole(match, "match"),
                       uncertainty.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                             : uncertainty.get<double>()});
  }

  [[nodiscard]] const Json& at(const Json& answer, const std::string& key) const {
    const auto found = answer.find(key);
    if (found == answer.end()) refuse("no '" + key + "': is this what `run` wrote?");
    return *found;
  }

  [[nodiscard]] std::uint64_t whole(const Json& number, const std::string& key) const {
    constexpr std::uint64_t most = std::uint64_t{1} << 62U;
    if (!number.is_number_unsigned() || number.get<std::uint64_t>() > most)
      refuse("'" + key + "' is no whole number up to 2^62");
    return number.get<std::uint64_t>();
  }

  [[noreturn]] void refuse(const std::string& why) const { throw SetupError({where_, why}); }

  std::string name_;
  std::string swept_;
  std::string where_;
};

std::vector<Answer> from_lines(std::string_view text, const std::string& name,
                               const std::string& swept) {
  Lines lines(name, swept);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") != std::string_view::npos) lines.take(line, number);
  }
  return std::move(lines.answers);
}

}  // namespace

std::vector<Answer> parse_answers(std::string_view text, const std::string& name,
                                  ThresholdOn threshold_on) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool json = first != std::string_view::npos && text[first] == '{';
  const std::string swept = name_of(threshold_on);
  std::vector<Answer> answers =
      json ? from_lines(text, name, swept) : from_table(CsvTable(text, name), swept);
  std::set<std::uint64_t> seen;
  for (const Answer& answer : answers) {
    if (!seen.insert(answer.query).second) {
      throw SetupError({name, "query " + std::to_string(answer.query) + " is answered twice"});
    }
  }
  return answers;
}

std::vector<Answer> read_answers(const std::filesystem::path& file, ThresholdOn threshold_on) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;  // a `run` of 90 hours at 30 fps
  return parse_answers(files::read_text(file, most_bytes), file.string(), threshold_on);
}

}  // namespace seqloop::evaluation
