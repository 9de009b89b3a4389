// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "program/fleet/allowance.hpp"
#include "program/fleet/fleet_settings.hpp"
#include "program/fleet/others.hpp"
#include "program/fleet/place_queue.hpp"
#include "program/map/lasting_map.hpp"
#include "seqloop/dds/fleet.hpp"
#include "seqloop/linux/detail/return_queue.hpp"

namespace seqloop::program {

/// What a robot tells others and hears of them, in a thread of its own: neither the loop nor the
/// disk waits for the network.
class FleetTalk {
 public:
  /// All of them live longer; the map has not begun yet. Throws SetupError.
  FleetTalk(const FleetSettings& settings, const dds::Participant& participant, LastingMap& map);
  FleetTalk(const FleetTalk&) = delete;
  FleetTalk& operator=(const FleetTalk&) = delete;
  FleetTalk(FleetTalk&&) = delete;
  FleetTalk& operator=(FleetTalk&&) = delete;
  ~FleetTalk();

  /// The loop's side: what has been heard, in order.
  [[nodiscard]] PlaceQueue& heard() noexcept { return heard_; }

  /// A frame of this drive that was at a place of another, or at one of this robot's own.
  struct Found {
    std::uint64_t frame = 0;    ///< as its source counts
    std::uint32_t session = 0;  ///< as it was heard
    std::uint64_t session_frame = 0;
    std::optional<std::uint64_t> own = {};  ///< number of the own place, instead of these two
  };
  /// The loop's side: others are told that these are one place, unless there is no room just now.
  void found(const Found& found) noexcept { static_cast<void>(found_.push(found)); }

  /// What has become of a frame of this drive.
  struct Judged {
    std::uint64_t frame = 0;  ///< as its source counts
    bool loop = false;        ///< it was at a place of this robot's own map
  };
  /// The loop's side, of each frame, where novel places alone are told.
  void judged(const Judged& judged) noexcept { static_cast<void>(judged_.push(judged)); }

  /// Names of a session of which a place has been heard.
  [[nodiscard]] const Others::Names& names(std::uint32_t session) const {
    return others_.names(session);
  }

  /// One line of what there is to say of others. Never waits.
  [[nodiscard]] std::optional<std::string> news();

  /// Tells the rest, for a second at most.
  void end();

  struct Counts {
    std::uint64_t told = 0;      ///< places, and again those of earlier sessions
    std::uint64_t known = 0;     ///< places that are not told, being none that is novel
    std::uint64_t untold = 0;    ///< places that there was no room for: the network is too slow
    std::uint64_t heard = 0;     ///< places that were taken in
    std::uint64_t sessions = 0;  ///< that they are of
  };
  /// After `end`.
  [[nodiscard]] Counts counts();

 private:
  // Statistics are told when a session has so many places, and twice as many, and so on; and last.
  static constexpr std::uint64_t first_statistics = 64;

  /// A place that waits to be told.
  struct Waiting {
    SavedPlace place;  // without name and bytes
    std::vector<std::byte> bytes;
  };
  /// By what the running session is standardised.
  struct Statistics {
    std::int64_t began_ns = 0;
    std::uint64_t frames = 0;  // 0: nothing is known
    std::vector<double> mean;
    std::vector<double> variance;
  };
  /// The newest statistics; the thread that saves may outlive this object.
  struct Learnt {
    std::mutex mutex;
    Statistics statistics;
  };

  void work();
  void tell_earlier();
  void read_newest();
  void tell_newest();
  [[nodiscard]] std::optional<bool> is_novel(std::uint64_t frame);
  void tell_found();
  [[nodiscard]] std::optional<dds::FleetVisit> place_of(const Found& found) const;
  void tell_statistics(std::uint64_t places);
  bool tell(const SavedPlace& place);
  bool publish(const dds::FleetPlace& place, const dds::FleetSession* about);
  void hear();
  void pass_on(std::string line);

  LastingMap* map_;
  std::shared_ptr<Learnt> learnt_;
  dds::FleetSession about_;
  std::vector<std::int64_t> earlier_;
  dds::Fleet wire_;
  Others others_;
  PlaceQueue heard_;
  live::ReturnQueue<Found, 1024> found_;
  live::ReturnQueue<Judged, 1024> judged_;

  Allowance allowance_;  // the thread's, as what follows
  std::size_t room_;     // for what waits
  std::deque<Waiting> waiting_;
  std::uint64_t untold_ = 0;
  std::string running_;  // name of the running session
  bool novel_;
  std::map<std::uint64_t, bool> loops_;  // by frame, as far as a place may come
  std::uint64_t newest_judged_ = 0;
  std::uint64_t newest_novel_ = 0;
  std::unordered_set<std::uint64_t> told_frames_;  // of the running session, where not all are
  std::uint64_t known_ = 0;
  std::uint64_t told_ = 0;
  std::uint64_t of_session_ = 0;  // told of the session that was told of last
  std::int64_t session_ = 0;
  std::uint64_t statistics_after_ = first_statistics;  // places of the running session
  std::optional<dds::FleetVisit> newest_told_;         // of the running session
  std::unordered_set<std::uint64_t> linked_;           // its frames whose own place is told already
  std::unordered_map<std::uint64_t, dds::FleetVisit> told_as_;  // by number; 40 bytes a place

  std::mutex mutex_;
  std::deque<std::string> news_;  // under the mutex
  std::atomic<bool> has_news_{false};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace seqloop::program
