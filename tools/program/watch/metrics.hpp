// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "program/watch/watch.hpp"

namespace seqloop::program {

/// What a monitor is told beside a run's own counts.
struct MonitorFacts {
  std::string version;
  std::uint64_t places_room = 0;     ///< places that the map has room for
  std::uint64_t memory_planned = 0;  ///< bytes
  std::uint64_t memory_used = 0;     ///< bytes that are resident
  std::uint64_t unseen = 0;          ///< frames and answers that went by unseen
  std::uint64_t connections = 0;
  std::uint64_t bytes_sent = 0;
  bool healthy = true;
};

/// A run's counts in the text format of Prometheus, version 0.0.4.
[[nodiscard]] std::string metrics(const Snapshot& snapshot, const MonitorFacts& facts);

}  // namespace seqloop::program
