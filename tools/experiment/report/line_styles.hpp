// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "experiment/report/selection.hpp"

namespace seqloop::experiment {

/// Eight colours that stay apart for colour-blind eyes, then the same with dashes.
struct LineStyle {
  std::size_t colour;  ///< class `cN` of the style sheet
  std::size_t dash;    ///< class `dN`; 0 is a whole line
};

/// Which style a line has, the same in every figure of a report. A line is known by the method of
/// its results, with the descriptor where the report has the method with several, if that tells the
/// lines of its figure apart, else by its name. No two lines of one figure share a style (while
/// there are at most 40).
class LineStyles {
 public:
  explicit LineStyles(const Report& report);

  /// @param line a key under `figure.line`, of a result that the figure shows
  [[nodiscard]] LineStyle of(const Figure& figure, const Key& line) const;

 private:
  std::map<const Figure*, std::map<Key, std::string>> figures_;  ///< what each line is known by
  std::map<std::string, std::size_t> styles_;
};

/// Style sheet of the charts, for light and dark screens and for paper.
[[nodiscard]] std::string chart_style_sheet();

}  // namespace seqloop::experiment
