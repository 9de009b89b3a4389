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

/// Sums are not wider than the values are: of pairs, and of two of these, there are means. Each is
/// rounded up; where both pairs' were, one half too many is taken off again. Values are `raised_by`
/// 127: the sum of four was above 0 where their raised one is 509 or more, and then this last mean
/// is 128 or more.
void sketches(const std::uint8_t* both, const SketchedValue* chosen, std::size_t words,
              std::uint64_t* const* out) noexcept {
  static_assert(values_per_bit == 4);
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<std::uint8_t, sketched_together> lanes;
  const hn::RebindToSigned<decltype(lanes)> with_sign;
  constexpr std::size_t width = hn::MaxLanes(lanes);
  constexpr std::size_t parts = sketched_together / width;
  // Bits that are gathered before they go to their word: as wide as the means are.
  constexpr std::size_t bits_together = 8;
  const auto one = hn::Set(lanes, 1);
  const SketchedValue* end = chosen;
  for (std::size_t word = 0; word < words; ++word) {
    std::uint64_t whole[sketched_together] = {};
    for (std::size_t part = 0; part < 64; part += bits_together) {
      end += bits_together * values_per_bit;
      // The highest bit first: each one moves those that are there on.
      const SketchedValue* value = end;
      hn::Vec<decltype(with_sign)> bits[parts];
      for (auto& some : bits) some = hn::Zero(with_sign);
      for (std::size_t bit = 0; bit < bits_together; ++bit) {
        value -= values_per_bit;
        for (std::size_t p = 0; p < parts; ++p) {
          const auto load = [&](std::size_t v) {
            return hn::LoadU(lanes, both + value[v] * sketched_together + p * width);
          };
          const auto a = load(0);
          const auto b = load(1);
          const auto c = load(2);
          const auto d = load(3);
          const auto rounded = hn::And(hn::And(hn::Xor(a, b), hn::Xor(c, d)), one);
          const auto mean =
              hn::AverageRound(hn::Sub(hn::AverageRound(a, b), rounded), hn::AverageRound(c, d));
          // What is true is -1.
          const auto above = hn::BroadcastSignBit(hn::BitCast(with_sign, mean));
          bits[p] = hn::Sub(hn::Add(bits[p], bits[p]), above);
        }
      }
      std::int8_t gathered[sketched_together];
      for (std::size_t p = 0; p < parts; ++p) hn::StoreU(bits[p], with_sign, gathered + p * width);
      for (std::size_t i = 0; i < sketched_together; ++i) {
        whole[i] |= std::uint64_t{static_cast<std::uint8_t>(gathered[i])} << part;
      }
    }
    for (std::size_t i = 0; i < sketched_together; ++i) out[i][word] = whole[i];
  }
}

}  // namespace
}  // namespace seqloop::kernels
