// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace seqloop {

/// Words of a sketch of 2,048 bits: 256 bytes a place.
inline constexpr std::size_t sketch_words = 32;

/// Values that a bit adds up. On Gardens Point and Nordland, 2 to 32 find the same share of loops
/// within the noise; this is cheap and among the best.
inline constexpr std::size_t values_per_bit = 4;

/// One of the values that a bit adds up: its place in a descriptor that is followed by its
/// negative.
using SketchedValue = std::uint32_t;

/// Values that a sketch of this many words adds up.
[[nodiscard]] constexpr std::size_t sketched_values(std::size_t words) noexcept {
  return words * 64 * values_per_bit;
}

/// Chooses the values of all bits, the same ones for the same D on every processor.
/// @param descriptor_size D, 1 .. most_small_values; zero padding would dilute the sums
/// @param out [sketched_values(words)] written; those of a longer sketch begin with the shorter's
void choose_sketched_values(std::size_t descriptor_size, std::span<SketchedValue> out) noexcept;

/// Values and their negatives are written so much larger: then none is below 0, and the highest bit
/// of four values' mean, rounded up, is whether their sum was above 0.
inline constexpr std::uint8_t raised_by = 127;

/// Writes a descriptor and its negative behind it, so that nothing but adding is left to do.
/// @param descriptor [D] -127 .. 127   @param out [2 D] written, `raised_by`
void with_negative(std::span<const std::int8_t> descriptor, std::span<std::uint8_t> out) noexcept;

/// Keeps of a descriptor on which side of some planes it lies: bit b is whether the sum of
/// `values_per_bit` of its values, chosen by chance, half of them by chance subtracted, is above 0.
/// The chance is fixed and the arithmetic whole: the same on every processor. The more two
/// descriptors are alike, the fewer bits differ, about words * 64 * angle / pi; so descriptors
/// should be standardised, or all would lie on the same sides.
/// @param both   [2 D] the descriptor `with_negative`
/// @param chosen [sketched_values(words)] for this D
/// @param out    [words] written
/// Work: words * 64 * values_per_bit adds, whatever D is. Allocates: never.
/// Source: src/README.md, section 5.3.
void sketch(std::span<const std::uint8_t> both, std::span<const SketchedValue> chosen,
            std::span<std::uint64_t> out) noexcept;

/// Descriptors that are sketched together: what is looked up for one of their values is looked up
/// for all, and their sums are added side by side, in a fraction of the time.
inline constexpr std::size_t sketched_together = 32;

/// Values that `side_by_side` writes, and needs room for.
[[nodiscard]] constexpr std::uint64_t side_by_side_values(std::size_t descriptor_size) noexcept {
  return std::uint64_t{2} * sketched_together * descriptor_size;
}

/// Writes value 0 of all descriptors, then value 1 of all, and so on; and then all negatives.
/// @param descriptors [D] each, -127 .. 127, outside of `out`
/// @param out [side_by_side_values(D)] written, `raised_by`
/// Work: 3 times what is written. Allocates: never.
void side_by_side(std::span<const std::int8_t* const, sketched_together> descriptors,
                  std::size_t descriptor_size, std::span<std::uint8_t> out) noexcept;

/// What `IntegerKernels::sketch_together` is, in plain C++.
void sketch_together(const std::uint8_t* both, const SketchedValue* chosen, std::size_t words,
                     std::uint64_t* const* out) noexcept;

/// How far apart two unit vectors are, of which so large a share of the bits differs: the angle
/// between them is about pi times the share. The sine is Bhaskara's, which is off by .002 at most
/// and the same on every processor.
[[nodiscard]] constexpr double chord(double share) noexcept {
  const double x = share / 2.0 * (1.0 - share / 2.0);
  return 32.0 * x / (5.0 - 4.0 * x);
}

/// Its square.
[[nodiscard]] constexpr double squared_chord(double share) noexcept {
  const double d = chord(share);
  return d * d;
}

}  // namespace seqloop
