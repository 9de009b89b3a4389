// SPDX-License-Identifier: MIT
#include "seqloop/detail/contrast.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop {

Contrast::Contrast(std::size_t rwindow) noexcept
    : reach_(rwindow / 2),
      lift_(2.0 * static_cast<double>(reach_) / std::sqrt(static_cast<double>(2 * reach_ + 1))) {}

namespace {

template <class Value>
double enhanced(std::span<const Value> column, std::size_t row, std::size_t reach, double lift) {
  const std::size_t first = row - std::min(row, reach);
  const std::size_t last = std::min(row + reach + 1, column.size());
  const auto count = static_cast<double>(last - first);
  double sum = 0.0;
  for (std::size_t r = first; r < last; ++r) sum += static_cast<double>(column[r]);
  const double mean = sum / count;
  double squares = 0.0;
  for (std::size_t r = first; r < last; ++r) {
    const double apart = static_cast<double>(column[r]) - mean;
    squares += apart * apart;
  }
  // Of a single row there is no deviation.
  const double deviation = squares > 0.0 ? std::sqrt(squares / (count - 1.0)) : 0.0;
  const double apart = static_cast<double>(column[row]) - mean;
  const double standardised = deviation > 0.0 ? apart / deviation : 0.0;
  return std::max(standardised + lift, 0.0);
}

}  // namespace

float Contrast::enhance(std::span<const float> column, std::size_t row,
                        double scale) const noexcept {
  return static_cast<float>(enhanced(column, row, reach_, lift_) * scale);
}

std::uint16_t Contrast::enhance(std::span<const std::uint16_t> column, std::size_t row,
                                double scale) const noexcept {
  constexpr double half = 0.5;
  return static_cast<std::uint16_t>(
      static_cast<std::int32_t>(enhanced(column, row, reach_, lift_) * scale + half));
}

}  // namespace seqloop
