#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "kernels/blocks.hpp"
#include "seqloop/integer_kernels.hpp"

// The portable variant: Highway's headers turn it into the instructions that the file which
// includes this one is compiled for. Nothing of Highway is linked.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

namespace hn = hwy::HWY_NAMESPACE;

struct HighwayProducts {
  using Vector = hn::Vec<hn::ScalableTag<std::int32_t>>;
  struct Sum {
    Vector low;
    Vector high;  // some processors keep half of the sums here
  };
  static constexpr std::uint32_t row_offset = 0;

  static Sum zero() noexcept {
    const hn::ScalableTag<std::int32_t> wide;
    return {hn::Zero(wide), hn::Zero(wide)};
  }

  static Sum add(Sum sum, const std::int8_t* row, const std::int8_t* query) noexcept {
    const hn::ScalableTag<std::int32_t> wide;
    const hn::ScalableTag<std::int16_t> middle;
    const hn::Rebind<std::int8_t, decltype(middle)> narrow;
    for (std::size_t i = 0; i < row_bytes; i += hn::Lanes(middle)) {
      const auto a = hn::PromoteTo(middle, hn::LoadU(narrow, row + i));
      const auto b = hn::PromoteTo(middle, hn::LoadU(narrow, query + i));
      sum.low = hn::ReorderWidenMulAccumulate(wide, a, b, sum.low, sum.high);
    }
    return sum;
  }

  static std::uint32_t total(Sum sum) noexcept {
    const hn::ScalableTag<std::int32_t> wide;
    return static_cast<std::uint32_t>(
        hn::GetLane(hn::SumOfLanes(wide, hn::Add(sum.low, sum.high))));
  }

  static void store_totals(const Sum (&sums)[rows_abreast], std::uint32_t /*too_much*/,
                           std::int32_t* out) noexcept {
    for (std::size_t row = 0; row < rows_abreast; ++row) {
      out[row] = static_cast<std::int32_t>(total(sums[row]));
    }
  }
};

struct HighwayDifferences {
  using Sum = hn::Vec<hn::ScalableTag<std::uint64_t>>;

  static Sum zero() noexcept { return hn::Zero(hn::ScalableTag<std::uint64_t>()); }

  static Sum add(Sum sum, const std::uint64_t* a, const std::uint64_t* b) noexcept {
    const hn::ScalableTag<std::uint64_t> words;
    const hn::ScalableTag<std::uint8_t> bytes;
    auto bits = hn::Zero(bytes);
    for (std::size_t i = 0; i < row_bytes / sizeof(std::uint64_t); i += hn::Lanes(words)) {
      const auto differ = hn::Xor(hn::LoadU(words, a + i), hn::LoadU(words, b + i));
      bits = hn::Add(bits, hn::PopulationCount(hn::BitCast(bytes, differ)));
    }
    return hn::Add(sum, hn::SumsOf8(bits));
  }

  static std::uint32_t total(Sum sum) noexcept {
    const hn::ScalableTag<std::uint64_t> words;
    return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(words, sum)));
  }
};

}  // namespace
}  // namespace seqloop::kernels
