// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "experiment/report/chart_data.hpp"

namespace seqloop::experiment {

/// The panels of a chart, each an `<svg class="chart">` that needs `chart_style_sheet` on its page.
[[nodiscard]] std::vector<std::string> panel_svgs(const Chart& chart);

/// The whole figure as a file of its own, with its styles inside.
[[nodiscard]] std::string figure_svg(const Chart& chart, const std::string& title);

}  // namespace seqloop::experiment
