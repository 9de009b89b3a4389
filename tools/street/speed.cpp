// SPDX-License-Identifier: MIT
#include "speed.hpp"

#include <algorithm>
#include <cmath>

#include "math.hpp"

namespace seqloop::street {

std::vector<double> positions(std::size_t frames, double length, std::uint64_t seed) {
  std::vector<double> at(frames, 0.0);
  if (frames < 2) return at;
  const auto key = static_cast<std::uint32_t>(hash_of(seed, 0x73706565));
  // at[i] first holds the speed on the way to frame i.
  for (std::size_t i = 1; i < frames; ++i) {
    const auto t = static_cast<float>(i);
    at[i] = static_cast<double>(0.74F + 0.42F * noise(t / 61.0F, 0.5F, key) +
                                0.10F * noise(t / 13.0F, 1.5F, key));
  }
  const std::size_t events = frames >= 60 ? std::max<std::size_t>(1, frames / 180) : 0;
  for (std::size_t k = 0; k < events; ++k) {
    Dice dice(hash_of(seed, 0x68616c74, k));
    const double share = static_cast<double>(frames) / static_cast<double>(events);
    const auto middle = static_cast<double>(k) * share + share * dice.range(0.2, 0.8);
    const auto half = 0.5 * (4.0 + dice.below(3));
    const double ramp = dice.range(2.0, 5.0);
    for (std::size_t i = 1; i < frames; ++i) {
      const double far = std::fabs(static_cast<double>(i) + 0.25 - middle) - half;
      if (far < ramp) at[i] *= far <= 0.0 ? 0.0 : 0.3 + 0.7 * far / ramp;
      if (static_cast<double>(i) > middle + half + ramp) break;
    }
  }
  double sum = 0.0;
  for (std::size_t i = 1; i < frames; ++i) at[i] = sum += at[i];
  const double scale = sum > 0.0 ? length / sum : 0.0;
  for (double& p : at) p *= scale;
  at.back() = length;
  return at;
}

}  // namespace seqloop::street
