// SPDX-License-Identifier: MIT
#include "program/bench/fastest_read.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>

namespace seqloop::program {
namespace {

using Memory = std::span<const std::byte>;
using Way = std::function<void()>;

/// Short enough to stay in the nearest cache, and for the C library to use its loop of loads.
constexpr std::size_t piece_bytes = 2048;

void copy_pieces(Memory memory, std::size_t streams, std::span<std::byte> near) {
  const std::size_t share = memory.size() / streams;
  for (std::size_t first = 0; first < share; first += near.size()) {
    const std::size_t size = std::min(near.size(), share - first);
    for (std::size_t stream = 0; stream < streams; ++stream) {
      std::memcpy(near.data(), memory.data() + stream * share + first, size);
    }
  }
}

std::uint64_t add_up(Memory memory) {
  std::array<std::uint64_t, 8> sums{};
  const std::size_t block = sizeof(sums);
  for (std::size_t first = 0; first + block <= memory.size(); first += block) {
    std::array<std::uint64_t, sums.size()> words;
    std::memcpy(words.data(), memory.data() + first, block);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += words[i];
  }
  return std::accumulate(sums.begin(), sums.end(), std::uint64_t{0});
}

std::vector<Way> all_ways(Memory memory) {
  std::vector<Way> ways;
  // Shared, so that nobody can know that what is copied and added up is never looked at.
  const auto near = std::make_shared<std::vector<std::byte>>(piece_bytes);
  const auto sum = std::make_shared<std::uint64_t>(0);
  for (const std::size_t streams : {1U, 2U, 4U, 8U}) {
    ways.emplace_back([=] { copy_pieces(memory, streams, *near); });
  }
  ways.emplace_back([=] { *sum += add_up(memory); });
  return ways;
}

/// The shortest of a few times.
std::chrono::nanoseconds time_of(const Way& way) {
  constexpr std::size_t tries = 4;
  auto shortest = std::chrono::nanoseconds::max();
  for (std::size_t i = 0; i < tries; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    way();
    shortest =
        std::min<std::chrono::nanoseconds>(shortest, std::chrono::steady_clock::now() - begin);
  }
  return shortest;
}

std::size_t beyond_every_cache() {
  constexpr std::size_t most = std::size_t{1} << 30U;
  const auto pages = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES));
  return std::min(most, pages / 4 * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)));
}

}  // namespace

std::function<void()> fastest_read(Memory memory) {
  std::vector<Way> ways = all_ways(memory);
  std::vector<std::chrono::nanoseconds> times;
  times.reserve(ways.size());
  for (const Way& way : ways) times.push_back(time_of(way));
  return std::move(ways[static_cast<std::size_t>(std::ranges::min_element(times) - times.begin())]);
}

void time_memory(std::size_t rounds, std::vector<Contender>& timed) {
  // Not zeros: pages that were never written can all be the same one.
  const std::vector<std::byte> memory(beyond_every_cache(), std::byte{1});
  std::vector<Contender> contenders;
  contenders.push_back(
      {"memory", "dram-read-bandwidth", 0, 0, memory.size(), fastest_read(memory)});
  time_in_turn(std::move(contenders), rounds, timed);
}

}  // namespace seqloop::program
