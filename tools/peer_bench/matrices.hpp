// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "program/bench/matrix_bench.hpp"

namespace seqloop::peers {

/// The products of all queries with all places, by OpenBLAS on one thread: the matrix alone,
/// without any matches.
[[nodiscard]] std::vector<program::Contender> matrices(const program::MatrixData& data);

}  // namespace seqloop::peers
