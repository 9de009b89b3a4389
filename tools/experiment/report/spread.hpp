// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace seqloop::experiment {

/// Positions in the order of `wanted`, at least `gap` apart and in [low, high] while they fit, and
/// as near to the wanted ones as that allows (least squares; pool adjacent violators).
[[nodiscard]] std::vector<double> spread(const std::vector<double>& wanted, double gap, double low,
                                         double high);

}  // namespace seqloop::experiment
