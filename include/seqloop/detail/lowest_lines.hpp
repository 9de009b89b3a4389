// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "seqloop/detail/candidate_runs.hpp"
#include "seqloop/detail/loop_decision.hpp"
#include "seqloop/detail/pending_answers.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/detail/sequence_search.hpp"

namespace seqloop {

/// Lists the best lines of a frame, the lowest score first: of rows that lie side by side, one.
/// @param runs  rows that were scored   @param best of them, with its uniqueness
/// @param lines room for as many as are kept
/// @return how many there are. Work: 13 scores a row. Allocates: never.
[[nodiscard]] std::size_t lowest_lines(const SequenceSearch& search, const PlaceOrder& order,
                                       std::span<const CandidateRun> runs, const BestRow& best,
                                       std::span<FoundLine> lines) noexcept;

}  // namespace seqloop
