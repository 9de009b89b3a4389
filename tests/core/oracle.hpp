#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "seqloop/matcher_config.hpp"

namespace seqloop::oracle {

using Vectors = std::vector<std::vector<float>>;

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
};

/// ALGORITHMS §3 to §6 written down as they stand, on the whole matrix, in double, without any
/// thought of speed. @param reference empty: close loops within the query.
std::vector<Answer> match(const Vectors& reference, const Vectors& query,
                          const MatcherConfig& config);

/// Random unit vectors that drift, so that neighbours look alike. @param seed printed by the caller
Vectors drive(std::uint32_t seed, std::size_t frames, std::size_t size, float noise = 0.0F);

}  // namespace seqloop::oracle
