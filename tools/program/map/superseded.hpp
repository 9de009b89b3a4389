// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace seqloop::program {

/// Sessions that a map can do without, because what they saw was seen again often enough since:
/// .6 of their places in six later sessions or more, and no stretch of more than 60 was not.
/// Sessions go whole: lines run through the places of one session, and find little in its pieces.
/// @param sessions the oldest first; of each place in order, the number of its first visit
/// @return their indices, rising
[[nodiscard]] std::vector<std::size_t> superseded(
    std::span<const std::vector<std::uint64_t>> sessions);

}  // namespace seqloop::program
