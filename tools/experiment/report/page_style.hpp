// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop::experiment {

/// Style sheet of the page around the charts, for screens from 390 pixels up, light and dark, and
/// for paper.
[[nodiscard]] const char* page_style_sheet();

}  // namespace seqloop::experiment
