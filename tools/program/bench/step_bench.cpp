// SPDX-License-Identifier: MIT
#include "program/bench/step_bench.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "program/options/matcher_settings.hpp"
#include "program/process/available_memory.hpp"
#include "program/process/say.hpp"
#include "synthetic/driven_detector.hpp"

namespace seqloop::program {
namespace {

// Long turns: in the caches, a step finds what the step before has left there.
constexpr Turn turn{10, 100};

void time_together(const std::vector<TimedMethod>& methods, const Capacity& size,
                   std::size_t rounds, std::vector<Contender>& timed) {
  std::vector<std::unique_ptr<DrivenDetector>> drives;
  std::vector<Contender> contenders;
  for (const TimedMethod& method : methods) {
    DrivenDetector* const drive =
        drives.emplace_back(std::make_unique<DrivenDetector>(method.config, size)).get();
    contenders.push_back({"step", method.by, size.places, size.descriptor_size, 0,
                          [drive] { drive->step(); }, [drive] { drive->drive(); }});
  }
  const std::size_t first = timed.size();
  time_in_turn(std::move(contenders), rounds, timed, turn);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    timed[first + i].bytes = drives[i]->bytes_a_step();
    say("step by {} among {} places: {:.1f} % of the frames found", methods[i].by, size.places,
        100.0 * drives[i]->found());
  }
}

}  // namespace

std::vector<TimedMethod> timed_methods(std::size_t ds, double relocalise_s, std::size_t places) {
  MatcherConfig exhaustive;
  exhaustive.keyframes = false;  // each frame does all the work
  exhaustive.sequence_length = ds;
  MatcherConfig relocalising = exhaustive;
  MatcherSettings settings;
  settings.relocalise_s = relocalise_s;
  suit_slice(relocalising, settings, places);
  exhaustive.candidates = Candidates::all;
  MatcherConfig exact = exhaustive;
  exact.arithmetic = Arithmetic::float32;
  return {{"seqloop-int8-exhaustive", exhaustive},
          {"seqloop-int8-o-relocalising", relocalising},
          {"seqloop-float-exhaustive", exact}};
}

void time_steps(const Capacity& size, std::size_t ds, double relocalise_s, std::size_t rounds,
                std::vector<Contender>& timed) {
  std::vector<TimedMethod> together;
  std::uint64_t bytes = 0;
  for (TimedMethod& method : timed_methods(ds, relocalise_s, size.places)) {
    const std::uint64_t more = DrivenDetector::bytes_needed(method.config, size);
    if (!fits_memory(more, fmt::format("step by {} among {} places", method.by, size.places))) {
      continue;
    }
    if (bytes + more > available_memory() / 2) {
      time_together(std::exchange(together, {}), size, rounds, timed);
      bytes = 0;
    }
    together.push_back(std::move(method));
    bytes += more;
  }
  time_together(together, size, rounds, timed);
}

}  // namespace seqloop::program
