// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "seqloop/detail/sketch.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::oracle {

using Vectors = std::vector<std::vector<float>>;

/// A descriptor in every form in which it can be compared.
struct Forms {
  explicit Forms(std::vector<float> descriptor);

  std::vector<float> values;
  std::vector<std::int8_t> bytes;
  double inverse_length;
  std::array<std::uint64_t, sketch_words> sketch;
};

/// The difference of two in the configuration's arithmetic: a whole number but for `float32`.
double difference(const MatcherConfig& config, const Forms& a, const Forms& b);

/// What a difference of 1 is.
double unit(const MatcherConfig& config);

/// A line of velocity m / ds, and the rows that it lies above its centre row at each column
/// (src/README.md, section 3.3).
struct Line {
  std::int64_t m;
  std::vector<std::int64_t> rows;
};

/// All lines, slowest first (src/README.md, section 4.2).
std::vector<Line> lines(const MatcherConfig& config);

/// One answered frame as the definitions give it.
struct Answer {
  std::int64_t query;
  std::int64_t match;
  double score;
  double uniqueness;  // NaN where not defined
  double velocity;
  std::int64_t head;
  std::int64_t candidates;
  std::int64_t k;
  std::optional<std::int64_t> runner_up;
};

/// src/README.md, sections 3 and 4, written down as they stand, on the whole matrix, in double,
/// without any thought of speed. @param reference empty: close loops within the query.
std::vector<Answer> match(const Vectors& reference, const Vectors& query,
                          const MatcherConfig& config);

/// Random unit vectors that drift, so that neighbours look alike. @param seed printed by the caller
Vectors drive(std::uint32_t seed, std::size_t frames, std::size_t size, float noise = 0.0F);

}  // namespace seqloop::oracle
