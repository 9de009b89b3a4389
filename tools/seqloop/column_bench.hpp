#pragma once

#include <functional>
#include <random>
#include <span>
#include <vector>

#include "seqloop/contender.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// What a rival takes the distances between.
struct ColumnData {
  Capacity size;
  std::span<const float> query;  ///< [D] of length 1
  std::span<const float> rows;   ///< [N, padded_size(D)] of length 1, zero beyond D
};

/// Makes contenders of other libraries; what they hold of the data may be views.
using RivalColumns = std::function<std::vector<Contender>(const ColumnData&)>;

/// A column of distances: int8 by every variant that this processor has (the one in use first),
/// sketches, float, the rivals, and how long it takes just to read the rows in int8 and in float.
/// Rows are read again and again: from the cache that they fit, if they fit one.
void time_columns(const Capacity& size, const RivalColumns& rivals, std::size_t rounds,
                  std::vector<Contender>& timed);

/// A random direction. @return [size] of length 1
[[nodiscard]] std::vector<float> random_unit(std::mt19937& random, std::size_t size);

}  // namespace seqloop::program
