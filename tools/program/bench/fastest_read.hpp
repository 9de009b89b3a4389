// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "program/bench/contender.hpp"

namespace seqloop::program {

/// Reads memory front to back, on one thread, in the way that proves fastest here: the C library
/// copies it piece by piece to where the nearest cache holds it, with the widest loads that the
/// processor has, from one to eight places in turn; or plain code adds it up. What that is as fast
/// as depends on where the memory is when it is read again: in a cache as long as it fits one.
/// @param memory must outlive what is returned
/// Work: each way is tried a few times first.
[[nodiscard]] std::function<void()> fastest_read(std::span<const std::byte> memory);

/// Reads what fits no cache: 1 GiB, or a quarter of the machine's memory where that is less. Even
/// this comes in part from a cache where a virtual machine's share is larger than that.
void time_memory(std::size_t rounds, std::vector<Contender>& timed);

}  // namespace seqloop::program
