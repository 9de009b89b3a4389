// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiment/report/chart_data.hpp"

namespace seqloop::experiment {

/// What a page is known by as one of these, near its start.
inline constexpr std::string_view page_mark = "<meta name=\"generator\" content=\"seqloop eval\"/>";

/// The report as one HTML page, which is well-formed XML too. It needs nothing from outside and
/// runs no script; it only links to results.csv and the figures' files.
/// @param charts what the report's figures draw, one each
/// @param figure_files names of the figures' own files, one each
[[nodiscard]] std::string page_html(const Report& report, const std::vector<Chart>& charts,
                                    const std::vector<std::string>& figure_files);

}  // namespace seqloop::experiment
