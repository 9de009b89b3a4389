// SPDX-License-Identifier: MIT
#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "seqloop/detail/sketch.hpp"

// Highway's headers turn this into the instructions that the file which includes it is compiled
// for. The sums are whole numbers: the same everywhere.
namespace seqloop::kernels {
// Every file has its own, compiled for its processor. NOLINTNEXTLINE(cert-dcl59-cpp)
namespace {

void sketches(const std::int8_t* both, const SketchedValue* chosen, std::size_t words,
              std::uint64_t* const* out) noexcept {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<std::int16_t, sketched_together> sums;
  const hn::Rebind<std::int8_t, decltype(sums)> bytes;
  constexpr std::size_t width = hn::MaxLanes(sums);
  constexpr std::size_t parts = sketched_together / width;
  // Bits that are gathered before they go to their word: as wide as the sums are.
  constexpr std::size_t bits_together = 16;
  const SketchedValue* end = chosen;
  for (std::size_t word = 0; word < words; ++word) {
    std::uint64_t whole[sketched_together] = {};
    for (std::size_t part = 0; part < 64; part += bits_together) {
      end += bits_together * values_per_bit;
      // The highest bit first: each one moves those that are there on.
      const SketchedValue* value = end;
      hn::Vec<decltype(sums)> bits[parts];
      for (auto& some : bits) some = hn::Zero(sums);
      for (std::size_t bit = 0; bit < bits_together; ++bit) {
        value -= values_per_bit;
        for (std::size_t p = 0; p < parts; ++p) {
          auto sum = hn::Zero(sums);
          for (std::size_t v = 0; v < values_per_bit; ++v) {
            const std::int8_t* const from = both + value[v] * sketched_together + p * width;
            sum = hn::Add(sum, hn::PromoteTo(sums, hn::LoadU(bytes, from)));
          }
          // What is true is -1.
          const auto above = hn::VecFromMask(sums, hn::Gt(sum, hn::Zero(sums)));
          bits[p] = hn::Sub(hn::Add(bits[p], bits[p]), above);
        }
      }
      std::int16_t gathered[sketched_together];
      for (std::size_t p = 0; p < parts; ++p) hn::StoreU(bits[p], sums, gathered + p * width);
      for (std::size_t i = 0; i < sketched_together; ++i) {
        whole[i] |= std::uint64_t{static_cast<std::uint16_t>(gathered[i])} << part;
      }
    }
    for (std::size_t i = 0; i < sketched_together; ++i) out[i][word] = whole[i];
  }
}

}  // namespace
}  // namespace seqloop::kernels
