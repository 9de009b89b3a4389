// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "seqloop/clock.hpp"
#include "seqloop/dds/participant.hpp"

namespace seqloop::dds {

/// What all places of a session have in common: only such places can be compared.
struct FleetSession {
  std::string robot;  ///< its name
  std::string name;
  std::string form;       ///< how a place is kept
  std::string describer;  ///< what made the descriptors
  std::uint32_t descriptor_size = 0;
  std::uint32_t place_bytes = 0;
};

/// A place that was told before.
struct FleetVisit {
  std::int64_t session = 0;
  std::uint64_t frame = 0;
};

/// By what a session's places were standardised.
struct FleetStatistics {
  std::uint64_t frames = 0;
  std::span<const double> mean;      ///< [D]
  std::span<const double> variance;  ///< [D]
};

/// A place of a robot.
struct FleetPlace {
  std::int64_t session = 0;  ///< when it began, in nanoseconds since 1970: its name for ever
  std::uint64_t frame = 0;   ///< of the session
  std::int64_t time_ns = 0;  ///< of the frame, in the session's own clock
  std::span<const std::byte> bytes{};
  /// Nothing new: the place was told before, and this is the same place, seen earlier.
  std::optional<FleetVisit> visit = {};
  /// No place, but what is known of its session by now.
  std::optional<FleetStatistics> statistics = {};
};

/// Places that robots tell each other, on the topic `seqloop_fleet/places`
/// (`platform/dds/idl/fleet.idl`): RELIABLE, TRANSIENT_LOCAL, the newest places of each session
/// kept for who joins late. The fleet's name is the partition. For one thread.
class Fleet {
 public:
  /// @param participant lives longer   @param name of the fleet   @param kept places of a session
  /// Throws SetupError.
  Fleet(const Participant& participant, const std::string& name, std::size_t kept);
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;
  Fleet(Fleet&&) = delete;
  Fleet& operator=(Fleet&&) = delete;
  ~Fleet();

  /// @param session what there is to say of it with this place; null: nothing
  /// @return false where others are too slow just now: try again. Waits a tenth of a second at
  ///   most. Allocates: yes.
  [[nodiscard]] bool publish(const FleetPlace& place, const FleetSession* session);

  /// Returns when there is something to take, or after the time.
  void wait(Nanoseconds at_most) noexcept;

  /// Takes one thing that others have published, oldest first of each session.
  /// @param hear what it is given is valid during the call; the session: null where nothing was
  /// said
  /// @param gone told of a session instead that nobody tells any more; empty: nobody asks
  /// @return whether there was one
  bool take(const std::function<void(const FleetPlace&, const FleetSession*)>& hear,
            const std::function<void(std::int64_t session)>& gone = {});

  /// Robots that are heard.
  [[nodiscard]] std::uint32_t others() const noexcept;

  /// Returns when all others that are there have what was published, or after the time.
  void flush(Nanoseconds at_most) noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::dds
