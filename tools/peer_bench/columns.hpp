// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "program/bench/column_bench.hpp"

namespace seqloop::peers {

/// The same column by Eigen, OpenBLAS and FAISS, each on one thread: products of the query with
/// every place by the first two, the nearest place by the third: among all of them, and, where that
/// may be built, by a graph (HNSW with 32 links), which can miss it.
[[nodiscard]] std::vector<program::Contender> columns(const program::ColumnData& data);

}  // namespace seqloop::peers
