// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

/// All results as comma-separated values with a header line: pair, method, descriptor, every
/// setting that any result has (in the order in which they appear; empty where a result has none),
/// then `number_columns`. Numbers are written %.9g in every locale, an undefined one as `nan`;
/// cells are quoted as RFC 4180 says, lines end in a line feed.
[[nodiscard]] std::string results_csv(const std::vector<Result>& results);

}  // namespace seqloop::experiment
