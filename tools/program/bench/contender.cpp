// SPDX-License-Identifier: MIT
#include "program/bench/contender.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace seqloop::program {
namespace {

constexpr Nanoseconds most_time = std::chrono::seconds(20);
constexpr Nanoseconds most_untimed = std::chrono::seconds(1);

Nanoseconds time_of_round(Contender& contender) {
  if (contender.prepare) contender.prepare();
  const auto begin = std::chrono::steady_clock::now();
  contender.round();
  return std::chrono::steady_clock::now() - begin;
}

/// @return how long it took
Nanoseconds take_turn(Contender& contender, Turn turn, Nanoseconds most) {
  Nanoseconds taken{0};
  for (std::size_t round = 0; round < turn.untimed && taken < most_untimed; ++round) {
    taken += time_of_round(contender);
  }
  for (std::size_t round = 0; round < turn.timed && (round == 0 || taken < most); ++round) {
    const Nanoseconds time = time_of_round(contender);
    contender.times.add(time);
    taken += time;
  }
  return taken;
}

}  // namespace

void time_in_turn(std::vector<Contender> contenders, std::size_t rounds,
                  std::vector<Contender>& timed, Turn turn) {
  std::vector<Nanoseconds> left(contenders.size(), most_time);
  for (std::size_t done = 0; done < rounds; done += turn.timed) {
    const Turn this_turn{turn.untimed, std::min(turn.timed, rounds - done)};
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (left[i] > Nanoseconds{0}) left[i] -= take_turn(contenders[i], this_turn, left[i]);
    }
  }
  for (Contender& contender : contenders) {
    contender.round = nullptr;
    contender.prepare = nullptr;
    timed.push_back(std::move(contender));
  }
}

}  // namespace seqloop::program
