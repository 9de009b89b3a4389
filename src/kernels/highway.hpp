// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "kernels/blocks.hpp"
#include "seqloop/detail/integer_kernels.hpp"

// The portable variant: Highway's headers turn it into the instructions that the file which
// includes this one is compiled for. Nothing of Highway is linked.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Adds up the quarters, eighths or however many parts of four lanes a vector has.
/// @param out [4]
template <class Vector>
void store_parts_of_four(Vector sums, std::uint32_t* out) noexcept {
  const hn::DFromV<Vector> lanes;
  if constexpr (hn::MaxLanes(lanes) > sums_together) {
    const hn::Half<decltype(lanes)> half;
    store_parts_of_four(hn::Add(hn::LowerHalf(half, sums), hn::UpperHalf(half, sums)), out);
  } else {
    hn::StoreU(sums, lanes, out);
  }
}

/// Lanes of a at even places, of b at odd ones, two of each added up.
template <class Vector>
Vector added_pairs(Vector a, Vector b) noexcept {
  return hn::Add(hn::InterleaveLower(a, b), hn::InterleaveUpper(hn::DFromV<Vector>(), a, b));
}

struct HighwayProducts {
  using Wide = hn::ScalableTag<std::int32_t>;
  using Middle = hn::ScalableTag<std::int16_t>;
  struct Sum {
    hn::Vec<Wide> low;
    hn::Vec<Wide> high;  // some processors keep half of the sums here
  };
  using Row = hn::Vec<Middle>;
  using Query = hn::Vec<Middle>;
  static constexpr std::size_t step = hn::MaxLanes(Middle());
  static constexpr bool exceeds = false;
  static constexpr std::size_t block_queries = 4;
  static constexpr std::size_t block_rows = 2;
  static constexpr std::size_t column_rows = 4;

  static Sum zero() noexcept { return {hn::Zero(Wide()), hn::Zero(Wide())}; }

  static Row row(const std::int8_t* from) noexcept {
    return hn::PromoteTo(Middle(), hn::LoadU(hn::Rebind<std::int8_t, Middle>(), from));
  }

  static Query query(const std::int8_t* from) noexcept { return row(from); }

  static Sum add(Sum sum, Row row, Query query) noexcept {
    sum.low = hn::ReorderWidenMulAccumulate(Wide(), row, query, sum.low, sum.high);
    return sum;
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    const hn::ScalableTag<std::uint32_t> lanes;
    const hn::ScalableTag<std::uint64_t> pairs;
    const auto both = [&](const Sum& sum) {
      return hn::BitCast(lanes, hn::Add(sum.low, sum.high));
    };
    const auto first = added_pairs(both(sums[0]), both(sums[1]));
    const auto last = added_pairs(both(sums[2]), both(sums[3]));
    const auto a = hn::BitCast(pairs, first);
    const auto b = hn::BitCast(pairs, last);
    store_parts_of_four(hn::Add(hn::BitCast(lanes, hn::InterleaveLower(a, b)),
                                hn::BitCast(lanes, hn::InterleaveUpper(pairs, a, b))),
                        out);
  }
};

struct HighwayDifferences {
  using Words = hn::ScalableTag<std::uint64_t>;
  using Sum = hn::Vec<Words>;

  static Sum zero() noexcept { return hn::Zero(Words()); }

  template <std::size_t words>
  static Sum add(Sum sum, const std::uint64_t* a, const std::uint64_t* b) noexcept {
    const hn::CappedTag<std::uint64_t, words> some;
    const hn::Repartition<std::uint8_t, decltype(some)> bytes;
    auto bits = hn::Zero(bytes);
    for (std::size_t i = 0; i < words; i += hn::MaxLanes(some)) {
      const auto differ = hn::Xor(hn::LoadU(some, a + i), hn::LoadU(some, b + i));
      bits = hn::Add(bits, hn::PopulationCount(hn::BitCast(bytes, differ)));
    }
    if constexpr (hn::MaxLanes(some) < hn::MaxLanes(Words())) {
      return hn::Add(sum, hn::ZeroExtendVector(Words(), hn::SumsOf8(bits)));
    } else {
      return hn::Add(sum, hn::SumsOf8(bits));
    }
  }

  static std::uint32_t total(Sum sum) noexcept {
    return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(Words(), sum)));
  }

  static void totals(const Sum (&sums)[sums_together], std::uint32_t* out) noexcept {
    // Counts fit 32 bits: two go into 64.
    const auto packed = [](Sum a, Sum b) { return hn::Or(a, hn::ShiftLeft<32>(b)); };
    const hn::ScalableTag<std::uint32_t> lanes;
    store_parts_of_four(
        hn::BitCast(lanes, added_pairs(packed(sums[0], sums[1]), packed(sums[2], sums[3]))), out);
  }
};

/// What both kinds of lanes have alike.
template <class Value_, class Number_>
struct HighwayNumbers {
  using Value = Value_;
  using Number = Number_;
  using Tag = hn::ScalableTag<Number>;
  using Sum = hn::Vec<Tag>;
  static constexpr std::size_t count = hn::MaxLanes(Tag());

  static Sum load(const Number* from) noexcept { return hn::LoadU(Tag(), from); }
  static void store(Sum sum, Number* to) noexcept { hn::StoreU(sum, Tag(), to); }
  static Sum widen(const Value* values) noexcept {
    return hn::PromoteTo(Tag(), hn::LoadU(hn::Rebind<Value, Tag>(), values));
  }
  static Sum number(std::uint32_t line) noexcept {
    return hn::Set(Tag(), static_cast<Number>(line));
  }
  static Sum add(Sum a, Sum b) noexcept { return hn::Add(a, b); }
  static Sum take_off(Sum a, Sum b) noexcept { return hn::Sub(a, b); }
};

struct HighwayLanes : HighwayNumbers<std::uint16_t, std::uint32_t> {
  static Sum load_lines(const std::uint32_t* from) noexcept { return load(from); }
  static void store_lines(Sum lines, std::uint32_t* to) noexcept { store(lines, to); }

  static void keep_lower(Sum sum, Sum line, Sum& best, Sum& best_line) noexcept {
    best_line = hn::IfThenElse(hn::Lt(sum, best), line, best_line);
    best = hn::Min(sum, best);
  }
};

#if HWY_HAVE_FLOAT64
struct HighwayDoubles : HighwayNumbers<float, double> {
  using Lines = hn::Rebind<std::int32_t, Tag>;
  static Sum load_lines(const std::uint32_t* from) noexcept {
    return hn::PromoteTo(Tag(),
                         hn::BitCast(Lines(), hn::LoadU(hn::RebindToUnsigned<Lines>(), from)));
  }
  static void store_lines(Sum lines, std::uint32_t* to) noexcept {
    const hn::RebindToUnsigned<Lines> narrow;
    hn::StoreU(hn::BitCast(narrow, hn::DemoteTo(Lines(), lines)), narrow, to);
  }

  static void keep_lower(Sum sum, Sum line, Sum& best, Sum& best_line) noexcept {
    const auto lower = hn::Lt(sum, best);
    best_line = hn::IfThenElse(lower, line, best_line);
    best = hn::IfThenElse(lower, sum, best);
  }
};
#endif

}  // namespace
}  // namespace seqloop::kernels
