// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/dots.hpp"
#include "kernels/hamming.hpp"
#include "kernels/lowest_lines.hpp"

namespace seqloop::kernels {

/// A variant that has all of its own.
template <class Products, class Differences, class Lanes>
constexpr IntegerKernels composed_of(
    std::string_view name, bool (*supported)() noexcept,
    decltype(IntegerKernels::sketch_together) sketch_together) noexcept {
  return {name,
          supported,
          &dot<Products>,
          &dot_column<Products>,
          &dot_block<Products>,
          &hamming<Differences>,
          &hamming_column<Differences>,
          &sum_diagonals<Lanes>,
          &lowest_lines<Lanes>,
          sketch_together};
}

}  // namespace seqloop::kernels
