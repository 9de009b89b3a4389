// SPDX-License-Identifier: MIT
#include "program/run/closures_bag.hpp"

#include "program/run/closure.hpp"

namespace seqloop::program {

ClosuresBag::ClosuresBag(const std::filesystem::path& path)
    : out_(path),
      bag_([this](std::span<const std::uint8_t> bytes) { out_.write(std::as_bytes(bytes)); }) {}

void ClosuresBag::add(std::span<const Answer> answers, const FrameTimes& times,
                      const StampAt& stamp_ns, const LastingMap* map) {
  for (const Answer& answer : answers) {
    if (!closes_loop(answer)) continue;
    const std::string_view session =
        map == nullptr ? std::string_view() : map->where(answer.match->place).session;
    bag_.add(closure_of(answer, times, stamp_ns, session), stamp_ns(times.newest_s()));
  }
}

void ClosuresBag::add(std::span<const OtherLoop> loops, const FrameTimes& times,
                      const StampAt& stamp_ns) {
  for (const OtherLoop& loop : loops) {
    bag_.add(closure_of(loop, times, stamp_ns), stamp_ns(times.newest_s()));
  }
}

void ClosuresBag::commit() {
  bag_.finish();
  out_.commit();
}

}  // namespace seqloop::program
