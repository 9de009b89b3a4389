// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "core/oracle.hpp"
#include "core/ways.hpp"

namespace seqloop::test {

/// What there is to see along a way, wider than any picture of it: neighbouring columns look alike.
class Panorama {
 public:
  /// Of the picture that a camera sees of it; `rows` of so many columns are a descriptor.
  static constexpr std::size_t columns = 7;
  static constexpr std::size_t rows = 20;
  static constexpr std::size_t size = rows * columns;

  /// @param seed of what a place shows, and of how each visit differs
  Panorama(std::uint32_t seed, std::size_t places) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<float> scene(rows * wide);
    for (std::size_t place = 0; place < places; ++place) {
      for (std::size_t row = 0; row < rows; ++row) {
        float beside = normal(random);
        for (std::size_t column = 0; column < wide; ++column) {
          beside = 0.4F * beside + normal(random);
          scene[row * wide + column] = 0.7F * scene[row * wide + column] + beside;
        }
      }
      scenes_.push_back(scene);
    }
  }

  /// What a camera sees of it. @param first column   @param noise beside what is there
  oracle::Vectors seen(std::size_t first, float noise, std::uint32_t visit) const {
    std::mt19937 random(visit);
    std::normal_distribution<float> normal;
    oracle::Vectors drive;
    for (const std::vector<float>& scene : scenes_) {
      std::vector<float> frame;
      for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = first; column < first + columns; ++column) {
          frame.push_back(scene[row * wide + column] + noise * normal(random));
        }
      }
      drive.push_back(frame);
    }
    return unit(drive);
  }

 private:
  static constexpr std::size_t wide = 3 * columns;
  oracle::Vectors scenes_;
};

}  // namespace seqloop::test
