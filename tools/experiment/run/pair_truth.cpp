// SPDX-License-Identifier: MIT
#include "experiment/run/pair_truth.hpp"

#include <fmt/format.h>

namespace seqloop::experiment {
namespace {

evaluation::Truth identity(const PairSpec& pair, const PairLengths& lengths, Faults& faults) {
  const std::uint64_t query = lengths.query.value_or(0);
  if (lengths.reference && lengths.query && *lengths.reference != query) {
    faults.push_back({pair.where,
                      fmt::format("pair '{}': frames i cannot belong together in drives of {} and "
                                  "of {} frames",
                                  pair.name, *lengths.reference, query),
                      "give a truth = \"FILE.csv\""});
  }
  return evaluation::Truth::identity(query);
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

evaluation::Truth pair_truth(const PairSpec& pair, const PairLengths& lengths, Faults& faults) {
  if (by_identity(pair.truth)) return identity(pair, lengths, faults);
  Faults found;
  evaluation::Truth truth = read_truth(pair.truth, found);
  for (const Fault& fault : found) {
    faults.push_back({pair.where, fault.what + ": " + fault.why, fault.remedy});
  }
  if (!found.empty()) return truth;
  check_reach(pair, "query", truth.queries_reach(), lengths.query, faults);
  check_reach(pair, "reference", truth.places_reach(), lengths.reference, faults);
  return truth;
}

}  // namespace seqloop::experiment
