// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// A result whose answers are right up to a recall, and then wrong ones come between.
/// @param recall_at_100_precision in (0, 1]; 0 for a result without answers
inline Result synthetic_result(std::string pair, std::string method, std::string descriptor,
                               std::vector<Setting> settings, double recall_at_100_precision) {
  Result result;
  result.pair = std::move(pair);
  result.method = std::move(method);
  result.descriptor = std::move(descriptor);
  result.settings = std::move(settings);
  result.places = 2400;
  result.queries = 2400;
  result.frames = 2400;
  result.descriptor_size = 735;
  result.seconds = 12.34;
  result.distances = 43264.5;
  if (recall_at_100_precision == 0.0) return result;
  const double recall = recall_at_100_precision;
  result.measures.recall_at_100_precision = recall;
  result.measures.area_under_curve = recall;
  result.measures.recall = recall;
  result.measures.precision = 0.75;
  result.measures.curve = {{recall / 2.0, 1.0}, {recall, 1.0}, {recall, 0.75}};
  return result;
}

}  // namespace seqloop::experiment
