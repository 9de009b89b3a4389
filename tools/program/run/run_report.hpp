// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "program/run/run_summary.hpp"
#include "seqloop/budget.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// What a thread cost the system since it was warm.
struct ThreadCost {
  std::uint64_t minor_faults = 0;  ///< pages that had to be mapped
  std::uint64_t major_faults = 0;  ///< pages that had to be read from a disk
};

/// From this frame on answers were accepted from this probability on.
struct ThresholdChange {
  std::uint64_t frame = 0;
  float min_probability = 0.0F;
};

/// What a run's numbers have to be read with.
struct RunConditions {
  std::filesystem::path source;
  std::filesystem::path reference;  ///< empty where loops are closed
  std::filesystem::path map;        ///< file of a map that lasts; empty without one
  std::string method;
  MatcherConfig config;
  std::size_t places = 0;           ///< room in the map
  std::size_t descriptor_size = 0;  ///< D
  Budget budget;
  OverloadRule overload;
  std::uint64_t overloads = 0;                ///< how often the policy came into force
  std::string capture;                        ///< the camera and its mode; empty for recordings
  std::vector<ThresholdChange> changes = {};  ///< by a person, while it ran
  ThreadCost cost;  ///< of the thread that decodes, describes, matches and writes
};

/// What a run was started with, and what was changed since: `source`, `method`, `decision`,
/// `budget_ms` and so on.
[[nodiscard]] nlohmann::ordered_json conditions_json(const RunConditions& conditions);

/// A run as one JSON object, newline included: conditions, counts, and of every stage its quantiles
/// and its histogram as `[longest_ms, frames]` of the buckets that are not empty.
[[nodiscard]] std::string run_report(const RunSummary& summary, const RunConditions& conditions);

}  // namespace seqloop::program
