// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "core/oracle.hpp"

namespace seqloop::test {

/// Each descriptor is given unit length.
inline oracle::Vectors unit(oracle::Vectors drive) {
  for (auto& descriptor : drive) {
    double squares = 0.0;
    for (const float value : descriptor) squares += static_cast<double>(value * value);
    for (float& value : descriptor) value /= static_cast<float>(std::sqrt(squares));
  }
  return drive;
}

/// A way through places: neighbours share most of what they look like. Two visits of one way differ
/// by noise.
/// @param size values in a descriptor   @param kept of what a place looks like, in the next one
inline oracle::Vectors way(std::uint32_t seed, std::size_t frames, float noise, std::uint32_t visit,
                           std::size_t size = 256, float kept = 0.8F) {
  std::mt19937 places(seed);
  std::mt19937 here(seed * 7919U + visit);
  const auto random = [](std::mt19937& engine) {
    return static_cast<float>(engine()) / 4294967296.0F - 0.5F;
  };
  oracle::Vectors drive(frames, std::vector<float>(size));
  std::vector<float> scene(size);
  for (auto& descriptor : drive) {
    for (std::size_t i = 0; i < size; ++i) {
      scene[i] = kept * scene[i] + random(places);
      descriptor[i] = scene[i] + noise * random(here);
    }
  }
  return unit(drive);
}

/// What is seen on the way from one place to the next. @param share of the way
/// @param noise of each value, at most half of it
inline std::vector<float> between(const std::vector<float>& from, const std::vector<float>& to,
                                  float share, float noise, std::mt19937& random) {
  std::vector<float> seen(from.size());
  for (std::size_t d = 0; d < seen.size(); ++d) {
    const float here = static_cast<float>(random()) / 4294967296.0F - 0.5F;
    seen[d] = (1.0F - share) * from[d] + share * to[d] + noise * here;
  }
  return seen;
}

/// So many frames for each of a drive, on the way from it to the next, and a little noise.
inline oracle::Vectors slowly(const oracle::Vectors& drive, std::size_t frames,
                              std::uint32_t seed) {
  std::mt19937 random(seed);
  oracle::Vectors slow;
  for (std::size_t at = 0; at + 1 < drive.size(); ++at) {
    for (std::size_t i = 0; i < frames; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(frames);
      slow.push_back(between(drive[at], drive[at + 1], share, 0.005F, random));
    }
  }
  return unit(slow);
}

}  // namespace seqloop::test
