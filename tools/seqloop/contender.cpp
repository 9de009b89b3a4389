#include "seqloop/contender.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace seqloop::program {
namespace {

// A turn's first rounds do not count: they find in the caches what another contender left there.
constexpr std::size_t untimed_a_turn = 3;
constexpr std::size_t timed_a_turn = 4;

void take_turn(Contender& contender, std::size_t timed_rounds) {
  for (std::size_t round = 0; round < untimed_a_turn; ++round) contender.round();
  for (std::size_t round = 0; round < timed_rounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    contender.round();
    contender.times.add(std::chrono::steady_clock::now() - begin);
  }
}

}  // namespace

void time_in_turn(std::vector<Contender> contenders, std::size_t rounds,
                  std::vector<Contender>& timed) {
  for (std::size_t done = 0; done < rounds; done += timed_a_turn) {
    for (Contender& contender : contenders) {
      take_turn(contender, std::min(timed_a_turn, rounds - done));
    }
  }
  for (Contender& contender : contenders) {
    contender.round = nullptr;
    timed.push_back(std::move(contender));
  }
}

}  // namespace seqloop::program
