// SPDX-License-Identifier: MIT
#include "sqlite/checksum.hpp"

#include <zlib.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <array>
#include <bit>

#include "sqlite/little_endian.hpp"

namespace seqloop::sqlite {
namespace {

std::uint32_t by_zlib(std::span<const std::byte> bytes, std::uint32_t before) noexcept {
  const void* const begin = bytes.data();
  return static_cast<std::uint32_t>(
      ::crc32_z(before, static_cast<const Bytef*>(begin), bytes.size()));
}

#if defined(__x86_64__)

constexpr std::size_t folded_size = 16;
constexpr std::size_t abreast = 4;
constexpr std::size_t step = abreast * folded_size;

bool folds() noexcept {
  __builtin_cpu_init();
  return __builtin_cpu_supports("pclmul") != 0;
}

/// Moves 16 bytes on, to where others are: these and those have the remainder that both had.
/// @param powers x to the number of bits that they move, and 64 more, modulo the polynomial
[[gnu::target("pclmul")]] __m128i moved(__m128i bytes, __m128i powers, __m128i there) noexcept {
  const __m128i low = _mm_clmulepi64_si128(bytes, powers, 0x00);
  const __m128i high = _mm_clmulepi64_si128(bytes, powers, 0x11);
  return _mm_xor_si128(_mm_xor_si128(low, high), there);
}

/// Makes of many bytes 16 that have the same remainder.
/// Source: Gopal et al., Fast CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction,
/// Intel 2009, whose constants these are.
/// @param bytes a whole number of steps, at least one   @param before all bits turned over
[[gnu::target("pclmul")]] std::array<std::byte, folded_size> folded(
    std::span<const std::byte> bytes, std::uint32_t before) noexcept {
  const __m128i by_step = _mm_set_epi64x(0x01C6E41596, 0x0154442BD4);
  const __m128i by_one = _mm_set_epi64x(0x00CCAA009E, 0x01751997D0);
  const auto load = [&bytes](std::size_t at) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes.data() + at));
  };
  __m128i sums[abreast];
  for (std::size_t i = 0; i < abreast; ++i) sums[i] = load(i * folded_size);
  sums[0] = _mm_xor_si128(sums[0], _mm_cvtsi32_si128(std::bit_cast<std::int32_t>(before)));
  for (std::size_t at = step; at < bytes.size(); at += step) {
    for (std::size_t i = 0; i < abreast; ++i) {
      sums[i] = moved(sums[i], by_step, load(at + i * folded_size));
    }
  }
  for (std::size_t i = 1; i < abreast; ++i) sums[i] = moved(sums[i - 1], by_one, sums[i]);
  std::array<std::byte, folded_size> last;
  _mm_storeu_si128(reinterpret_cast<__m128i*>(last.data()), sums[abreast - 1]);
  return last;
}

#endif

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) noexcept {
#if defined(__x86_64__)
  // Reading a map, this is most of what is computed: many times faster than by zlib's tables.
  static const bool fast = folds();
  if (fast && bytes.size() >= step) {
    const std::size_t whole = bytes.size() / step * step;
    const std::array<std::byte, folded_size> start = folded(bytes.first(whole), ~before);
    before = by_zlib(start, ~std::uint32_t{0});
    bytes = bytes.subspan(whole);
  }
#endif
  return by_zlib(bytes, before);
}

RowChecksum& RowChecksum::add(std::int64_t value) noexcept {
  std::array<std::byte, 8> eight{};
  store_u64(std::bit_cast<std::uint64_t>(value), eight);
  bytes(eight);
  return *this;
}

RowChecksum& RowChecksum::add(double value) noexcept {
  return add(std::bit_cast<std::int64_t>(value));
}

RowChecksum& RowChecksum::add(std::span<const std::byte> blob) noexcept {
  add(static_cast<std::int64_t>(blob.size()));
  bytes(blob);
  return *this;
}

}  // namespace seqloop::sqlite
