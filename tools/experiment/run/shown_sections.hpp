// SPDX-License-Identifier: MIT
#pragma once

#include "experiment/run/section.hpp"

namespace seqloop::experiment {

/// `[[figure]]` and `[[table]]`: what the report shows.
[[nodiscard]] Figure read_figure(const Section& section);
[[nodiscard]] Table read_table(const Section& section);

}  // namespace seqloop::experiment
