// SPDX-License-Identifier: MIT
#include "seqloop/difference.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "seqloop/detail/lane_sums.hpp"

namespace seqloop {
namespace {

/// Sums `term(a - b)` over all values, in a fixed order.
template <class Term>
double sum_of(std::span<const float> a, std::span<const float> b, Term term) noexcept {
  // Partial sums move to double before float has lost digits on long descriptors.
  double sum = 0.0;
  for (std::size_t first = 0; first < a.size(); first += float_block) {
    const std::size_t last = std::min(first + float_block, a.size());
    std::array<float, lanes> partial{};
    for (std::size_t i = first; i < last; i += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        partial[lane] += term(a[i + lane] - b[i + lane]);
      }
    }
    for (const float lane : partial) sum += static_cast<double>(lane);
  }
  return sum;
}

}  // namespace

double squared_distance(std::span<const float> a, std::span<const float> b) noexcept {
  return sum_of(a, b, [](float value) { return value * value; });
}

float euclidean(std::span<const float> a, std::span<const float> b) noexcept {
  return static_cast<float>(std::sqrt(squared_distance(a, b)));
}

float mean_absolute(std::span<const float> a, std::span<const float> b, std::size_t size) noexcept {
  const auto absolute = [](float value) { return std::abs(value); };
  return static_cast<float>(sum_of(a, b, absolute) / static_cast<double>(size));
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

double squared_norm(std::span<const float> vector) noexcept {
  return sum_in_lanes(vector.size(), [&](std::size_t i) {
    return static_cast<double>(vector[i]) * static_cast<double>(vector[i]);
  });
}

bool normalise(std::span<float> vector) noexcept {
  const double squares = squared_norm(vector);
  if (squares <= 0.0) return false;
  const double factor = 1.0 / std::sqrt(squares);
  for (float& value : vector) value = static_cast<float>(static_cast<double>(value) * factor);
  return true;
}

}  // namespace seqloop
