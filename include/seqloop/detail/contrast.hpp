// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop {

/// SeqSLAM's local contrast enhancement of one column of the difference matrix: how far a
/// difference lies from those of the rows around it, in their deviations.
class Contrast {
 public:
  /// @param rwindow rows of the neighbourhood beside the row itself; halved as the paper does
  explicit Contrast(std::size_t rwindow) noexcept;

  /// Rows on either side of a row that its value depends on.
  [[nodiscard]] std::size_t reach() const noexcept { return reach_; }

  /// No value is larger.
  [[nodiscard]] double largest() const noexcept { return 2.0 * lift_; }

  /// `(D[r] - mean) / deviation` over the rows r - reach .. r + reach clipped to the map, with the
  /// sample's deviation; 0 where nothing deviates. One constant is added to all so that no value is
  /// negative: (n - 1) / sqrt(n) with n = 2 reach + 1, as far below its mean as one of n values can
  /// lie. The least value of the whole matrix would need the whole matrix.
  /// @param column [rows of the map] differences, filled around the row; in any unit
  /// @param scale  what 1 becomes; 1 for float
  /// @return 0 .. 2 (n - 1) / sqrt(n), times scale; whole numbers are rounded, halves up
  /// Work: 2 n. Allocates: never. Source: src/README.md, sections 3.6
  /// and 4.7.
  [[nodiscard]] float enhance(std::span<const float> column, std::size_t row,
                              double scale) const noexcept;
  [[nodiscard]] std::uint16_t enhance(std::span<const std::uint16_t> column, std::size_t row,
                                      double scale) const noexcept;

 private:
  std::size_t reach_;
  double lift_;  // the constant
};

}  // namespace seqloop
