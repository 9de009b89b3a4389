// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace seqloop::program {

/// How long a robot or a keeper waits for what others tell, before it looks at what it has to do
/// itself.
constexpr std::chrono::milliseconds round_time{20};

/// Messages that are heard before that, however many there are.
constexpr std::size_t most_a_round = 4096;

/// What all places of a session have in common is said with its first place, and again with each
/// that has this many before it: who hears the newest ones alone learns it, too.
constexpr std::uint64_t said_every = 64;

}  // namespace seqloop::program
