// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "program/fleet/fleet_settings.hpp"
#include "program/fleet/others.hpp"
#include "seqloop/dds/fleet.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// Keeps what all robots of a fleet tell in one map file, each session of theirs as one, and tells
/// what nobody else tells any more. What is in the file when it is switched on, it tells at once.
/// For one thread.
class Keeper {
 public:
  /// @param file a map; one that is missing is made like the first places that are heard
  /// Throws SetupError.
  Keeper(std::filesystem::path file, const FleetSettings& settings,
         const dds::Participant& participant, double save_every_s);

  /// Hears, saves, tells. Returns after some 20 ms, or when `stop` says so.
  /// @param stop asked between two places that are told. Throws SetupError: the file is damaged.
  void round(const std::function<bool()>& stop);

  /// What a person should know, once.
  [[nodiscard]] std::vector<std::string> news() { return std::exchange(news_, {}); }

  /// Saves the rest. @return what is kept, for a person
  [[nodiscard]] std::string end();
  /// @return what the disk did not take, and why; empty: nothing waits
  [[nodiscard]] std::string unsaved() const;

 private:
  struct Session {
    Others::Names names;
    std::int64_t id = 0;       // in the file
    bool grows = true;         // told by a robot: its numbers are its own, and its frames
    std::uint64_t frames = 0;  // saved or waiting
    std::uint64_t untold = 0;  // frame from which on nobody has heard it from here
    bool gone = false;         // nobody else tells it
    bool closed = false;       // the file has no room behind its places
    // What waits to be saved.
    std::vector<sqlite::PlaceRecord> records;
    std::vector<std::byte> bytes;
    std::vector<sqlite::SavedLink> links;
    std::optional<sqlite::SavedStatistics> statistics;
  };

  /// The first place of a session that the file has not begun yet.
  struct First {
    dds::FleetPlace place;
    std::vector<std::byte> bytes;  // of it
    dds::FleetSession about;
    std::optional<std::uint32_t> index;  // in `others_`; none: there is no file yet
  };

  [[nodiscard]] bool can_be_kept(const dds::FleetPlace& place, const dds::FleetSession& about);
  [[nodiscard]] bool open(const dds::FleetSession& about);
  void know_sessions();
  void hear();
  void hear(const dds::FleetPlace& place, const dds::FleetSession* about);
  void begin(First first);
  void try_to_begin();
  Session& session(std::uint32_t index) { return sessions_[*heard_as_[index]]; }
  Session& session_in_file(std::uint32_t index);
  void keep(const dds::FleetPlace& place, Session& session);
  void save();
  void fail(std::string why);
  void tell(const std::function<bool()>& stop);
  [[nodiscard]] bool publish(const dds::FleetPlace& place, const dds::FleetSession* about,
                             const std::function<bool()>& stop);
  [[nodiscard]] std::optional<dds::FleetVisit> told_as(std::uint64_t number) const;

  std::filesystem::path path_;
  FleetSettings settings_;
  std::chrono::duration<double> save_every_;
  dds::Fleet wire_;
  std::optional<sqlite::MapFile> file_;
  std::optional<Others> others_;
  std::deque<Session> sessions_;                      // those that grow first by their index
  std::vector<std::optional<std::size_t>> heard_as_;  // by index in `others_`
  std::unordered_map<std::uint64_t, dds::FleetVisit> earlier_;  // by number: of what does not grow
  std::set<std::pair<std::uint64_t, std::uint64_t>> links_;
  std::optional<First> first_;  // waits for room on the disk, and so does what comes after it
  std::size_t waiting_ = 0;     // places
  std::chrono::steady_clock::time_point saved_;
  std::string failing_;       // why the disk takes nothing; empty: it does
  std::string stays_in_log_;  // why its log has to stay beside the map in the end; empty: it can go
  bool refusing_ = false;
  std::vector<std::string> news_;
};

}  // namespace seqloop::program
