// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstring>

#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/difference.hpp"

// Dot products of floats by Highway's headers, which turn this into the instructions that the file
// which includes it is compiled for. What is added to what is as in lane_dots.hpp.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

/// Vectors whose sums of lanes are added up together.
inline constexpr std::size_t added_together = 4;

/// Adds up the lanes of the sums of four vectors, and these in double to what was there.
/// @param sums [4, dot_lanes] aligned   @param totals [4]
HWY_INLINE void add_lanes(const float* sums, double* totals) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, dot_lanes> some;
  const hn::RepartitionToWide<decltype(some)> pairs;
  const auto both = [&](const float* from) {
    const auto a = hn::Load(some, from);
    const auto b = hn::Load(some, from + dot_lanes);
    return hn::BitCast(pairs, hn::Add(hn::InterleaveLower(a, b), hn::InterleaveUpper(some, a, b)));
  };
  // Of lanes 0 to 3 and 4 to 7 each: (0 + 2) + (1 + 3).
  const auto fours = [&](const float* from) {
    const auto first = both(from);
    const auto last = both(from + 2 * dot_lanes);
    return hn::Add(hn::BitCast(some, hn::InterleaveLower(first, last)),
                   hn::BitCast(some, hn::InterleaveUpper(pairs, first, last)));
  };
  alignas(stored_line) float parts[2 * added_together];
  for (std::size_t lane = 0; lane < dot_lanes; lane += hn::MaxLanes(some)) {
    hn::Store(fours(sums + lane), some, parts + lane);
  }
  const hn::CappedTag<double, added_together> wide;
  const hn::Rebind<float, decltype(wide)> narrow;
  for (std::size_t i = 0; i < added_together; i += hn::MaxLanes(wide)) {
    const auto both_parts =
        hn::Add(hn::Load(narrow, parts + i), hn::Load(narrow, parts + added_together + i));
    hn::StoreU(hn::Add(hn::LoadU(wide, totals + i), hn::PromoteTo(wide, both_parts)), wide,
               totals + i);
  }
}

/// Of vectors of which a register holds the lanes of several, or some lanes of one.
template <class Tag>
struct Registers {
  static constexpr std::size_t width = hwy::HWY_NAMESPACE::MaxLanes(Tag());
  static constexpr std::size_t vectors = width > dot_lanes ? width / dot_lanes : 1;
  static constexpr std::size_t lanes = width < dot_lanes ? width : dot_lanes;

  /// The lanes of a query, beside each other as often as a register has them.
  static HWY_INLINE auto query(const float* from) noexcept {
    namespace hn = hwy::HWY_NAMESPACE;
    if constexpr (vectors == 1) {
      return hn::LoadU(Tag(), from);
    } else {
      const hn::Half<Tag> half;
      const auto once = hn::LoadU(half, from);
      return hn::Combine(Tag(), once, once);
    }
  }
};

/// Adds the products of a part of some queries and some registers of rows, at most `float_block`
/// long. Loops are unrolled in a function of its own, or GCC would keep some sums in memory.
/// @param row       [registers, length * vectors]: where registers hold several rows, their lanes
///                  beside each other   @param row_stride from register to register
/// @param totals    the first query's of the first row
template <class Tag, std::size_t queries, std::size_t registers>
[[gnu::noinline]] void add_products(const float* query, std::size_t query_stride, const float* row,
                                    std::size_t row_stride, std::size_t length, double* totals,
                                    std::size_t out_stride) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  using Some = Registers<Tag>;
  constexpr std::size_t rows = registers * Some::vectors;
  static_assert(rows % added_together == 0);
  alignas(stored_line) float lane_sums[queries][rows * dot_lanes];
  for (std::size_t lane = 0; lane < dot_lanes; lane += Some::lanes) {
    hn::Vec<Tag> sums[queries][registers];
#pragma GCC unroll 16
    for (auto& of_query : sums) {
#pragma GCC unroll 16
      for (auto& sum : of_query) sum = hn::Zero(Tag());
    }
    for (std::size_t i = lane; i < length; i += dot_lanes) {
      hn::Vec<Tag> values[queries];
#pragma GCC unroll 16
      for (std::size_t q = 0; q < queries; ++q) {
        values[q] = Some::query(query + q * query_stride + i);
      }
#pragma GCC unroll 16
      for (std::size_t r = 0; r < registers; ++r) {
        const auto beside = hn::LoadU(Tag(), row + r * row_stride + i * Some::vectors);
#pragma GCC unroll 16
        for (std::size_t q = 0; q < queries; ++q) {
          sums[q][r] = hn::MulAdd(values[q], beside, sums[q][r]);
        }
      }
    }
#pragma GCC unroll 16
    for (std::size_t q = 0; q < queries; ++q) {
#pragma GCC unroll 16
      for (std::size_t r = 0; r < registers; ++r) {
        hn::Store(sums[q][r], Tag(), lane_sums[q] + r * Some::vectors * dot_lanes + lane);
      }
    }
  }
#pragma GCC unroll 16
  for (std::size_t q = 0; q < queries; ++q) {
#pragma GCC unroll 16
    for (std::size_t r = 0; r < rows; r += added_together) {
      add_lanes(lane_sums[q] + r * dot_lanes, totals + q * out_stride + r);
    }
  }
}

/// One query by some rows of any length.
/// @param row_stride 0 for a row that counts several times
template <std::size_t rows>
void dots_abreast(const float* query, const float* row, std::size_t row_stride, std::size_t length,
                  double* dots) noexcept {
  for (std::size_t r = 0; r < rows; ++r) dots[r] = 0.0;
  for (std::size_t first = 0; first < length; first += float_block) {
    const std::size_t part = length - first < float_block ? length - first : float_block;
    add_products<hwy::HWY_NAMESPACE::CappedTag<float, dot_lanes>, 1, rows>(
        query + first, 0, row + first, row_stride, part, dots, 0);
  }
}

void dots(const float* query, const float* rows, std::size_t stride, std::size_t count,
          double* out) noexcept {
  // Memory brings several long rows at a time sooner than few.
  constexpr std::size_t abreast = 2 * added_together;
  constexpr std::size_t long_row = 2048;
  std::size_t row = 0;
  for (; stride >= long_row && row + abreast <= count; row += abreast) {
    dots_abreast<abreast>(query, rows + row * stride, stride, stride, out + row);
  }
  for (; row + added_together <= count; row += added_together) {
    dots_abreast<added_together>(query, rows + row * stride, stride, stride, out + row);
  }
  for (; row < count; ++row) {
    double same[added_together];
    dots_abreast<added_together>(query, rows + row * stride, 0, stride, same);
    out[row] = same[0];
  }
}

/// Copies a part of some rows, the lanes of those that share a register beside each other.
/// @param near [rows / vectors, length * vectors]
template <std::size_t rows, std::size_t vectors>
HWY_INLINE void copy_rows(const float* row, std::size_t stride, std::size_t length,
                          float* near) noexcept {
  for (std::size_t r = 0; r < rows; r += vectors, row += vectors * stride) {
    if constexpr (vectors == 1) {
      std::memcpy(near, row, length * sizeof(float));
      near += length;
    } else {
      for (std::size_t i = 0; i < length; i += dot_lanes) {
        for (std::size_t v = 0; v < vectors; ++v, near += dot_lanes) {
          std::memcpy(near, row + v * stride + i, dot_lanes * sizeof(float));
        }
      }
    }
  }
}

/// Has memory fetched that comes next, some cache lines a call.
class Ahead {
 public:
  /// @param rows `length` values of each   @param calls of `some` until all are fetched
  Ahead(const float* row, std::size_t stride, std::size_t rows, std::size_t length,
        std::size_t calls) noexcept
      : row_(row), stride_(stride), length_(length), rest_(rows), each_(rows * length / calls) {}

  void some() noexcept {
    for (std::size_t i = 0; i <= each_ && rest_ > 0; i += stored_line / sizeof(float)) {
      __builtin_prefetch(row_ + at_, 0, 2);
      at_ += stored_line / sizeof(float);
      if (at_ < length_) continue;
      at_ = 0;
      row_ += stride_;
      --rest_;
    }
  }

 private:
  const float* row_;
  std::size_t stride_;
  std::size_t length_;
  std::size_t rest_;
  std::size_t each_;
  std::size_t at_ = 0;
};

/// Many vectors by many.
/// @tparam most queries at a time: with `registers` of rows as many sums as registers have room for
template <class Tag, std::size_t most, std::size_t registers>
void dots_of_block(const float* queries, std::size_t queries_count, const float* rows,
                   std::size_t stride, std::size_t count, double* out,
                   std::size_t out_stride) noexcept {
  constexpr std::size_t few = 2;
  constexpr std::size_t vectors = Registers<Tag>::vectors;
  constexpr std::size_t together = registers * vectors;
  const std::size_t whole_queries = queries_count / few * few;
  const std::size_t whole_rows = count / together * together;
  for (std::size_t q = 0; q < whole_queries; ++q) {
    for (std::size_t r = 0; r < whole_rows; ++r) out[q * out_stride + r] = 0.0;
  }
  for (std::size_t first = 0; first < stride; first += float_block) {
    const std::size_t length = stride - first < float_block ? stride - first : float_block;
    // Some rows stay in the nearest cache while the queries pass by: copied, because vectors that
    // are a whole number of pages long share few places there.
    alignas(stored_line) float near[together * float_block];
    for (std::size_t r = 0; r < whole_rows; r += together) {
      copy_rows<together, vectors>(rows + r * stride + first, stride, length, near);
      const std::size_t next = r + together;
      Ahead ahead(rows + next * stride + first, stride, next < whole_rows ? together : 0, length,
                  whole_queries / most + 1);
      for (std::size_t q = 0; q < whole_queries;) {
        ahead.some();
        const std::size_t left = whole_queries - q;
        const bool many = left >= most && left != most + 1;
        const auto add =
            many ? &add_products<Tag, most, registers> : &add_products<Tag, few, registers>;
        add(queries + q * stride + first, stride, near, length * vectors, length,
            out + q * out_stride + r, out_stride);
        q += many ? most : few;
      }
    }
  }
  for (std::size_t q = 0; q < queries_count; ++q) {
    const std::size_t done = q < whole_queries ? whole_rows : 0;
    dots(queries + q * stride, rows + done * stride, stride, count - done,
         out + q * out_stride + done);
  }
}

}  // namespace
}  // namespace seqloop::kernels
