// SPDX-License-Identifier: MIT
// Integer hashing: the only source of chance in the street, the same on every machine.
#pragma once

#include <cstdint>

namespace seqloop::street {

/// Scrambles 64 bits (the splitmix64 finaliser). @return every bit depends on every bit of x.
constexpr std::uint64_t mix64(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// Hash of a seed and any count of integer keys; the order of the keys matters.
template <class... Keys>
constexpr std::uint64_t hash_of(std::uint64_t seed, Keys... keys) noexcept {
  std::uint64_t h = mix64(seed);
  ((h = mix64(h ^ static_cast<std::uint64_t>(keys))), ...);
  return h;
}

/// @return h as a number in [0, 1).
constexpr double unit(std::uint64_t h) noexcept {
  return static_cast<double>(h >> 11U) * 0x1.0p-53;
}

/// A run of chance values that starts from one hash. Throw at most once in a call's arguments: the
/// order in which they are evaluated is the compiler's.
class Dice {
 public:
  explicit constexpr Dice(std::uint64_t seed) noexcept : state_(seed) {}

  constexpr std::uint64_t bits() noexcept { return state_ = mix64(state_); }
  /// @return uniform in [low, high).
  constexpr double range(double low, double high) noexcept {
    return low + (high - low) * unit(bits());
  }
  constexpr float rangef(float low, float high) noexcept {
    return low + (high - low) * static_cast<float>(unit(bits()));
  }
  /// @param count at least 1. @return uniform in 0..count-1.
  constexpr int below(int count) noexcept {
    return static_cast<int>(unit(bits()) * static_cast<double>(count));
  }
  /// @return true with the given probability, 0..1.
  constexpr bool chance(double probability) noexcept { return unit(bits()) < probability; }

 private:
  std::uint64_t state_;
};

/// Quick 32-bit hash of a lattice point, for textures.
constexpr std::uint32_t lattice(std::int32_t x, std::int32_t y, std::uint32_t seed) noexcept {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x8da6b343U) ^
                    (static_cast<std::uint32_t>(y) * 0xd8163841U);
  h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12U)) * 0x297a2d39U;
  return h ^ (h >> 15U);
}

/// @return lattice hash as a number in [0, 1).
constexpr float lattice_unit(std::int32_t x, std::int32_t y, std::uint32_t seed) noexcept {
  return static_cast<float>(lattice(x, y, seed) >> 8U) * 0x1.0p-24F;
}

}  // namespace seqloop::street
