// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>

#include "seqloop/difference.hpp"

// Highway's headers turn this into the instructions that the file which includes it is compiled
// for. What is added to what is as in difference.cpp.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// @param sums [rows] written
template <std::size_t rows>
void squares_abreast(const float* query, const float* row, std::size_t stride,
                     double* sums) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, lanes> some;
  constexpr std::size_t width = hn::MaxLanes(some);
  constexpr std::size_t parts = lanes / width;
  for (std::size_t r = 0; r < rows; ++r) sums[r] = 0.0;
  for (std::size_t first = 0; first < stride; first += float_block) {
    const std::size_t last = first + float_block < stride ? first + float_block : stride;
    hn::Vec<decltype(some)> partial[rows][parts];
    for (auto& of_row : partial) {
      for (auto& part : of_row) part = hn::Zero(some);
    }
    for (std::size_t i = first; i < last; i += lanes) {
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = i + part * width;
        const auto here = hn::LoadU(some, query + at);
        for (std::size_t r = 0; r < rows; ++r) {
          const auto differ = hn::Sub(here, hn::LoadU(some, row + r * stride + at));
          partial[r][part] = hn::Add(partial[r][part], hn::Mul(differ, differ));
        }
      }
    }
    for (std::size_t r = 0; r < rows; ++r) {
      float values[lanes];
      for (std::size_t part = 0; part < parts; ++part) {
        hn::StoreU(partial[r][part], some, values + part * width);
      }
      for (const float value : values) sums[r] += static_cast<double>(value);
    }
  }
}

void squares(const float* query, const float* rows, std::size_t stride, std::size_t count,
             double* sums) noexcept {
  // Memory brings several long rows at a time sooner than one after the other, and short ones in
  // the order in which they lie there.
  constexpr std::size_t abreast = 8;
  constexpr std::size_t long_row = 2048;
  std::size_t row = 0;
  for (; stride >= long_row && row + abreast <= count; row += abreast) {
    squares_abreast<abreast>(query, rows + row * stride, stride, sums + row);
  }
  for (; row < count; ++row) squares_abreast<1>(query, rows + row * stride, stride, sums + row);
}

}  // namespace
}  // namespace seqloop::kernels
