// SPDX-License-Identifier: MIT
#include "synthetic/places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "seqloop/difference.hpp"

namespace seqloop::program {
namespace {

constexpr double places_a_direction = 10.0;
constexpr std::uint64_t none = ~std::uint64_t{0};
constexpr std::uint64_t first_noise = std::uint64_t{1} << 40U;  // beyond every direction
constexpr std::uint64_t frames_a_carry = 500;
constexpr std::uint64_t frames_a_velocity = 100;

/// The n-th random number: SplitMix64.
std::uint64_t random_number(std::uint64_t n) {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

/// Evenly spread values around zero, about 1 long all together; those of each number are others.
void spread(std::uint64_t number, std::span<float> out) {
  constexpr std::size_t values_a_number = 4;
  const auto size = static_cast<float>(out.size());
  const float scale = std::sqrt(3.0F / size) / 32768.0F;
  const std::uint64_t first = number << 22U;
  for (std::size_t i = 0; i < out.size(); i += values_a_number) {
    std::uint64_t bits = random_number(first + i);
    for (std::size_t k = i; k < std::min(i + values_a_number, out.size()); ++k) {
      out[k] = static_cast<float>(static_cast<std::int16_t>(bits)) * scale;
      bits >>= 16U;
    }
  }
}

}  // namespace

SyntheticPlaces::SyntheticPlaces(std::size_t size)
    : directions_{Direction{none, std::vector<float>(size)},
                  Direction{none, std::vector<float>(size)}},
      noise_(size) {}

std::span<const float> SyntheticPlaces::direction(std::uint64_t number) {
  Direction& direction = directions_[static_cast<std::size_t>(number % directions_.size())];
  if (direction.number != number) {
    spread(number, direction.values);
    direction.number = number;
  }
  return direction.values;
}

void SyntheticPlaces::see(double position, float noise, std::span<float> out) {
  const double way = position / places_a_direction;
  const auto number = static_cast<std::uint64_t>(way);
  const std::span<const float> from = direction(number);
  const std::span<const float> to = direction(number + 1);
  const double turn = (way - static_cast<double>(number)) * std::numbers::pi / 2.0;
  const auto of_from = static_cast<float>(std::cos(turn));
  const auto of_to = static_cast<float>(std::sin(turn));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = of_from * from[i] + of_to * to[i];
  if (noise > 0.0F) {
    spread(first_noise + seen_++, noise_);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += noise * noise_[i];
  }
  normalise(out);
}

double SyntheticRobot::next() {
  const auto end = static_cast<double>(places_ - 1);
  if (frames_ % frames_a_velocity == 0) {
    velocity_ = std::uniform_real_distribution(0.9, 1.1)(random_);
  }
  position_ += velocity_;
  if (frames_ % frames_a_carry == 0 || position_ > end) {
    position_ = std::uniform_real_distribution(0.0, end)(random_);
  }
  ++frames_;
  return std::min(position_, end);
}

}  // namespace seqloop::program
