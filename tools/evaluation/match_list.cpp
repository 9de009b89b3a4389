// SPDX-License-Identifier: MIT
#include "evaluation/match_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "evaluation/csv.hpp"
#include "evaluation/line_faults.hpp"
#include "files/text_file.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

using Json = nlohmann::json;

/// Answers, each to another query.
class Answers {
 public:
  /// Throws SetupError: the query has an answer.
  void add(Answer answer, const std::string& where) {
    if (!queries_.insert(answer.query).second) {
      throw SetupError({where, "query " + std::to_string(answer.query) + " is answered twice"});
    }
    answers_.push_back(answer);
  }

  [[nodiscard]] std::vector<Answer> take() { return std::move(answers_); }

 private:
  std::vector<Answer> answers_;
  std::set<std::uint64_t> queries_;
};

std::vector<Answer> from_table(const CsvTable& table, const std::string& swept) {
  const std::vector<std::size_t> columns = table.columns({"query", "match", swept});
  const std::optional<std::size_t> probability = table.find("probability");
  const std::optional<std::size_t> accepted = table.find("accepted");
  Answers answers;
  table.for_each_row([&](CsvRow& row) {
    Answer answer{row.whole(columns[0]), row.whole(columns[1]), row.number(columns[2])};
    if (probability && !std::isnan(row.number(*probability))) {
      answer.probability = row.number_within(*probability, 0.0, 1.0);
    }
    if (accepted) answer.accepted = row.flag(*accepted);
    if (row.faults().empty()) answers.add(answer, row.where());
  });
  return answers.take();
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

  Answers answers;

 private:
  void add(const Json& answer) {
    const Json& query = at(answer, "frame");
    const Json& match = at(answer, "match");
    const Json& uncertainty = at(answer, swept_);
    if (query.is_null() || match.is_null()) return;
    Answer found{whole(query, "frame"), whole(match, "match"), number(uncertainty, swept_)};
    if (const auto said = answer.find("probability"); said != answer.end()) {
      found.probability = number(*said, "probability");
      if (found.probability < 0.0 || found.probability > 1.0)
        refuse("'probability' is not from 0 to 1");
    }
    if (const auto status = answer.find("status"); status != answer.end()) {
      found.accepted = *status == "match";
    }
    answers.add(found, where_);
  }

  /// NaN where it is null.
  [[nodiscard]] double number(const Json& number, const std::string& key) const {
    if (number.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (!number.is_number()) refuse("'" + key + "' is no number");
    return number.get<double>();
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
  LineFaults faults(name);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    faults.collect([&] { lines.take(line, number); });
  }
  faults.refuse();
  return lines.answers.take();
}

}  // namespace

std::string name_of(ThresholdOn threshold_on) {
  switch (threshold_on) {
    case ThresholdOn::score:
      return "score";
    case ThresholdOn::probability:
      return "probability";
    case ThresholdOn::uniqueness:
      break;
  }
  return "uniqueness";
}

double uncertainty(ThresholdOn threshold_on, double value) noexcept {
  return threshold_on == ThresholdOn::probability ? -value : value;
}

std::vector<Answer> parse_answers(std::string_view text, const std::string& name,
                                  ThresholdOn threshold_on) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool json = first != std::string_view::npos && text[first] == '{';
  const std::string swept = name_of(threshold_on);
  std::vector<Answer> answers =
      json ? from_lines(text, name, swept) : from_table(CsvTable(text, name), swept);
  for (Answer& answer : answers) {
    answer.uncertainty = uncertainty(threshold_on, answer.uncertainty);
  }
  return answers;
}

std::vector<Answer> read_answers(const std::filesystem::path& file, ThresholdOn threshold_on) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;  // a `run` of 90 hours at 30 fps
  return parse_answers(files::read_text(file, most_bytes), file.string(), threshold_on);
}

}  // namespace seqloop::evaluation
