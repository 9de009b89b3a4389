// SPDX-License-Identifier: MIT
#include "evaluation/match_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "evaluation/csv.hpp"
#include "evaluation/line_faults.hpp"
#include "files/text_file.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/frame_report.hpp"

namespace seqloop::evaluation {
namespace {

using Json = nlohmann::json;

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
    if (!row.faults().empty()) return;
    if (!answers.add(answer)) throw SetupError(Answers::answered_twice(row.where(), answer));
  });
  return answers.take();
}

/// Answers of `run`'s lines.
class Lines {
 public:
  Lines(std::string name, std::string swept) : name_(std::move(name)), swept_(std::move(swept)) {}

  /// Throws SetupError with all that is wrong with the line.
  void take(std::string_view line, std::size_t number) {
    where_ = name_ + ":" + std::to_string(number);
    faults_.clear();
    add_all(Json::parse(line, nullptr, false));
    if (!faults_.empty()) throw SetupError(faults_);
  }

  Answers answers;

 private:
  void add_all(const Json& json) {
    if (!json.is_object())
      return blame("is no JSON object", "leave whole lines of what `run` wrote");
    const auto several = json.find("answers");
    if (several == json.end()) return add(json);
    if (!several->is_array()) return blame("'answers' is no array");
    for (const Json& answer : *several) {
      if (answer.is_object()) {
        add(answer);
      } else {
        blame("'answers' holds what is no JSON object");
      }
    }
  }

  void add(const Json& answer) {
    const std::size_t before = faults_.size();
    const std::optional<std::uint64_t> query = whole(answer, "frame");
    const std::optional<std::uint64_t> match = whole(answer, "match");
    Answer found{query.value_or(0), match.value_or(0), number(answer, swept_)};
    if (answer.contains("probability")) {
      found.probability = number(answer, "probability");
      if (found.probability < 0.0 || found.probability > 1.0)
        blame("'probability' is not from 0 to 1");
    }
    if (!query || !match) return;
    if (answer.contains("status")) found.accepted = status(answer) == Gate::match;
    if (faults_.size() > before) return;
    if (!answers.add(found)) faults_.push_back(Answers::answered_twice(where_, found));
  }

  std::optional<Gate> status(const Json& answer) {
    const Json& word = answer.at("status");
    const std::optional<Gate> gate =
        word.is_string() ? gate_of(word.get_ref<const std::string&>()) : std::nullopt;
    if (!gate) blame("'status' is none that `run` writes", "write \"match\" of what is accepted");
    return gate;
  }

  /// NaN where it is null.
  double number(const Json& answer, const std::string& key) {
    const Json& number = at(answer, key);
    if (number.is_number()) return number.get<double>();
    if (!number.is_null()) blame("'" + key + "' is no number");
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// Nothing where it is null.
  std::optional<std::uint64_t> whole(const Json& answer, const std::string& key) {
    constexpr std::uint64_t most = std::uint64_t{1} << 62U;
    const Json& number = at(answer, key);
    if (number.is_null()) return std::nullopt;
    if (number.is_number_unsigned() && number.get<std::uint64_t>() <= most)
      return number.get<std::uint64_t>();
    blame("'" + key + "' is no whole number up to 2^62");
    return std::nullopt;
  }

  /// Null where it is missing.
  const Json& at(const Json& answer, const std::string& key) {
    static const Json null;
    const auto found = answer.find(key);
    if (found != answer.end()) return *found;
    blame("no '" + key + "': is this what `run` wrote?");
    return null;
  }

  void blame(std::string why, std::string remedy = {}) {
    faults_.push_back({where_, std::move(why), std::move(remedy)});
  }

  std::string name_;
  std::string swept_;
  std::string where_;
  Faults faults_;
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

bool Answers::add(const Answer& answer) {
  if (!queries_.insert(answer.query).second) return false;
  answers_.push_back(answer);
  return true;
}

Fault Answers::answered_twice(std::string where, const Answer& answer) {
  return {std::move(where), "query " + std::to_string(answer.query) + " is answered twice",
          "keep its best answer"};
}

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
