// SPDX-License-Identifier: MIT
#include "experiment/run/pair_truth.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace seqloop::experiment {
namespace {

evaluation::Truth identity(const PairSpec& pair, const PairLengths& lengths, Faults& faults) {
  std::vector<std::optional<std::uint64_t>> drives = lengths.queries;
  if (!pair.reference.empty()) drives.push_back(lengths.reference);
  const auto known = [](const auto& length) { return length.has_value(); };
  if (!std::ranges::all_of(drives, known)) return {};
  const auto [shortest, longest] = std::ranges::minmax(drives);
  if (shortest != longest) {
    faults.push_back({pair.where,
                      fmt::format("pair '{}': frames i cannot belong together in drives of {} and "
                                  "of {} frames",
                                  pair.name, *longest, *shortest),
                      "give a truth = \"FILE.csv\""});
  }
  return pair.reference.empty() ? evaluation::Truth::laps(*shortest, drives.size())
                                : evaluation::Truth::identity(*shortest);
}

void check_reach(const PairSpec& pair, const char* drive, std::uint64_t reach,
                 std::optional<std::uint64_t> length, Faults& faults) {
  if (!length || reach <= *length) return;
  faults.push_back({pair.where,
                    fmt::format("pair '{}': its truth names frame {} of the {}, which has {}",
                                pair.name, reach - 1, drive, *length),
                    "take the truth of these very drives"});
}

}  // namespace

std::optional<std::uint64_t> PairLengths::query() const {
  std::uint64_t sum = 0;
  for (const std::optional<std::uint64_t>& length : queries) {
    if (!length) return std::nullopt;
    sum += *length;
  }
  return sum;
}

std::optional<std::uint64_t> PairLengths::map(const PairSpec& pair) const {
  return pair.reference.empty() ? query() : reference;
}

evaluation::Truth pair_truth(const PairSpec& pair, const PairLengths& lengths, Faults& faults) {
  Faults found;
  evaluation::Truth truth = read_truth(pair.truth, found);
  for (const Fault& fault : found) {
    faults.push_back({pair.where, fault.what + ": " + fault.why, fault.remedy});
  }
  if (!found.empty()) return truth;
  if (by_identity(pair.truth)) return identity(pair, lengths, faults);
  check_reach(pair, "query", truth.queries_reach(), lengths.query(), faults);
  check_reach(pair, "reference", truth.places_reach(), lengths.map(pair), faults);
  return truth;
}

std::string how_judged(const PairSpec& pair) {
  std::string text = fmt::format("{}", fmt::join(pair.queries, ", then "));
  text += pair.reference.empty() ? ", closing loops" : " in " + pair.reference;
  if (pair.truth.file == "no-revisit") return text + "; every answer is wrong";
  const bool by_frame = by_identity(pair.truth);
  const std::string source = by_file(pair.truth) ? pair.truth.file.filename().string()
                             : by_frame          ? "identity"
                                                 : "positions";
  text += fmt::format("; truth: {}, within {}{}", source, how_near(pair.truth, {}),
                      by_file(pair.truth) ? ", or a row's own tolerance" : "");
  return pair.truth.unlisted == evaluation::Unlisted::unknown
             ? text + "; frames that it does not list are not judged"
             : text;
}

}  // namespace seqloop::experiment
