// SPDX-License-Identifier: MIT
#include "seqloop/difference.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "kernels/lane_dots.hpp"
#include "seqloop/detail/lane_sums.hpp"

namespace seqloop {

double dot(std::span<const float> a, std::span<const float> b) noexcept {
  return kernels::lane_dot(a.data(), b.data(), a.size());
}

float euclidean(std::span<const float> a, std::span<const float> b) noexcept {
  return static_cast<float>(std::sqrt(squared_distance(a, b)));
}

float euclidean(double aa, double bb, double ab) noexcept {
  return static_cast<float>(std::sqrt(std::max(0.0, aa + bb - 2.0 * ab)));
}

float mean_absolute(std::span<const float> a, std::span<const float> b, std::size_t size) noexcept {
  // Partial sums move to double before float has lost digits on long descriptors.
  constexpr std::size_t block = 64 * lanes;
  double sum = 0.0;
  for (std::size_t first = 0; first < a.size(); first += block) {
    const std::size_t last = std::min(first + block, a.size());
    std::array<float, lanes> partial{};
    for (std::size_t i = first; i < last; i += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        partial[lane] += std::abs(a[i + lane] - b[i + lane]);
      }
    }
    for (std::size_t lane = 0; lane < lanes; lane += 4) {
      sum += static_cast<double>((partial[lane] + partial[lane + 2]) +
                                 (partial[lane + 1] + partial[lane + 3]));
    }
  }
  return static_cast<float>(sum / static_cast<double>(size));
}

float difference(Difference kind, std::span<const float> a, std::span<const float> b,
                 std::size_t size) noexcept {
  return kind == Difference::euclidean ? euclidean(a, b) : mean_absolute(a, b, size);
}

bool blank(Difference kind, std::span<const float> descriptor) noexcept {
  const float flat =
      kind == Difference::euclidean || descriptor.empty() ? 0.0F : descriptor.front();
  return std::ranges::all_of(descriptor, [flat](float value) { return value == flat; });
}

bool all_finite(std::span<const float> values) noexcept {
  // By their bits and to the end, so that the compiler looks at several at once.
  constexpr std::uint32_t exponent = 0x7F80'0000U;
  std::uint32_t others = 0;
  for (const float value : values) {
    others |= (std::bit_cast<std::uint32_t>(value) & exponent) == exponent ? 1U : 0U;
  }
  return others == 0;
}

double squared_distance(std::span<const float> a, std::span<const float> b) noexcept {
  return sum_in_lanes(a.size(), [&](std::size_t i) {
    const double apart = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    return apart * apart;
  });
}

double squared_norm(std::span<const float> vector) noexcept {
  return sum_in_lanes(vector.size(), [&](std::size_t i) {
    return static_cast<double>(vector[i]) * static_cast<double>(vector[i]);
  });
}

bool normalise(std::span<float> vector) noexcept {
  const double squares = squared_norm(vector);
  if (squares <= 0.0 || !std::isfinite(squares)) return false;
  const double factor = 1.0 / std::sqrt(squares);
  for (float& value : vector) value = static_cast<float>(static_cast<double>(value) * factor);
  return true;
}

}  // namespace seqloop
