// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "program/map/map_settings.hpp"
#include "program/map/retire.hpp"
#include "program/map/stored_map.hpp"
#include "program/map/thumbnails.hpp"
#include "program/map/verdict.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {

/// Saves what a drive adds to a map, in a thread of its own. Places are in the map already: the
/// thread follows how far they are, and reads them there, so that no frame waits for the disk, but
/// where `MapSettings::waits` says so, and nothing queues up. Until a place is saved, a full map
/// does not forget it; nor does it forget the newest ones that are, so that what goes does not
/// depend on how far the thread is.
class MapWriter {
 public:
  /// All of them live longer. @param encode makes thumbnails; null: there are none
  /// @param learnt as `LastingMap::follow`; empty: nobody follows
  MapWriter(StoredMap& stored, const PlaceMap& map, const MatcherConfig& config,
            const MapSettings& settings, JpegEncoder encode, StatisticsReader learnt);

  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;
  MapWriter(MapWriter&&) = delete;
  MapWriter& operator=(MapWriter&&) = delete;
  ~MapWriter();

  /// Notes what the detector has made of a frame that it has just taken.
  /// @param counted the frame, as the detector counts; @param index as its source does
  /// @param image its picture, where there is one
  /// @param readable whether it has a descriptor that is not blank; until one has, nothing is
  /// saved, since a full map's places would go for a drive that is discarded
  /// Work: log N and what the frame added, a thumbnail's pixels; every few times D copies.
  /// Allocates: never. No system call, no waiting: but where `MapSettings::waits` says so, until no
  /// more than `kept` places are not saved yet; unless the disk refuses, or stalls for two seconds.
  void note(Detector& detector, std::uint64_t counted, std::uint64_t index, double time_s,
            const Image& image, std::span<const Answer> answers, bool readable) noexcept;

  /// The drive is over: saves the rest, however long that takes.
  /// @param rest answers of the detector's `finish`
  /// @return why something could not be saved; nothing when all is
  [[nodiscard]] std::optional<std::string> finish(Detector& detector, std::span<const Answer> rest);

  /// Saves what is noted so far, and no more from then on. The map may go after that.
  void stop();

  /// Frames of the drive, from the first on, that are on the disk for good.
  [[nodiscard]] std::uint64_t saved() const noexcept {
    return saved_frames_.load(std::memory_order_acquire);
  }

  /// Places that it has added to the file.
  [[nodiscard]] std::uint64_t saved_places() const noexcept {
    return saved_places_.load(std::memory_order_acquire);
  }

  /// How many places fewer than the map the file has, once the drive is over: those that could not
  /// be saved, less those that they were to take the room of. Work: one pass over the former.
  [[nodiscard]] std::uint64_t lacking() const noexcept;

  /// Saves soon. From any thread but a camera's loop: it may wait. @return false once the drive is
  /// over
  bool save_now();

  /// As `LastingMap::read_newest`. Work: D copies a place. Allocates: no.
  void read_newest(const SavedPlaceReader& read);

  /// Keeps a person's word on an answer, likewise.
  bool judge(std::uint64_t frame, std::uint64_t place, Verdict verdict);

  /// What is gone since the drive has superseded it.
  [[nodiscard]] const std::vector<Retired>& retired() const noexcept { return retired_; }

  /// Places that have no thumbnail for lack of room.
  [[nodiscard]] std::uint64_t missing_thumbnails() const noexcept {
    return thumbnails_ ? thumbnails_->missing() : 0;
  }

  /// What there is to say of the disk, once: that it refuses or stalls, or takes again. Never
  /// waits.
  [[nodiscard]] std::optional<std::string> trouble();

  /// The source's number of the frame that a place of this drive is. @param row of the map
  [[nodiscard]] std::uint64_t source_frame(std::size_t row) const noexcept {
    return source_frames_[map_->order().slot(row)];
  }

 private:
  /// A place that was added, where it is, and what went for it.
  struct Added {
    std::size_t slot;
    sqlite::PlaceRecord record;
    std::uint64_t gone;  // number of a place, or `none`
  };
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  /// Where a frame came from.
  struct Came {
    std::uint64_t index;
    std::int64_t time_ns;
    double probability;   // of the place that it was at; 0: of none
    std::uint64_t place;  // number
  };
  enum class Handing : std::uint8_t { idle, asked, ready };

  /// Newest places that a full map keeps, and that need not be saved before a frame waits: an
  /// eighth of it, 1 to 1024.
  [[nodiscard]] std::uint64_t kept() const noexcept;
  [[nodiscard]] static bool stalls(std::int64_t since_ns) noexcept;
  void wait_for_the_disk() noexcept;
  [[nodiscard]] Came& came(std::uint64_t counted) noexcept {
    return came_[static_cast<std::size_t>(counted % came_.size())];
  }
  void weigh(std::span<const Answer> answers) noexcept;
  void add_places(const Image& image) noexcept;
  void settle(std::uint64_t end) noexcept;
  void hand_over_statistics(const Detector& detector) noexcept;
  void work(double every_s);
  bool save();
  void save_once();
  [[nodiscard]] bool left() const;
  void tell(std::string text);
  [[nodiscard]] std::size_t words();

  StoredMap* stored_;
  const PlaceMap* map_;
  StatisticsReader learnt_;
  std::uint64_t settled_after_;  // frames after which a place is linked to no other any more
  std::uint64_t first_number_;   // of this drive's places

  // Of the loop.
  std::uint64_t next_number_;                 // of the place that is noted next
  bool ending_ = false;                       // the thread has ended
  std::uint64_t counted_ = 0;                 // frames
  std::uint64_t settled_ = 0;                 // places that have been
  double last_probability_ = 0.0;             // of a link
  bool comes_back_ = false;                   // whether an answer of this drive was accepted
  std::int64_t stalled_ns_ = 0;               // `saving_since_ns_` of the stall that was told
  std::vector<Came> came_;                    // [kept], a ring by frame
  std::vector<std::uint64_t> source_frames_;  // [capacity], by slot
  std::vector<std::uint64_t> numbers_;        // [capacity], by slot: of places, or `none`
  std::vector<std::uint64_t> linked_;         // [capacity], by slot: to which place, or `none`
  bool novel_;
  bool waits_;

  // Written by the loop, read by the thread up to the marks.
  std::vector<Added> added_;              // [capacity], a ring
  std::vector<sqlite::SavedLink> links_;  // [capacity], a ring: a link a place at most
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<std::uint64_t> places_noted_{0};
  std::atomic<std::uint64_t> links_noted_{0};
  std::atomic<Handing> handing_{Handing::asked};
  std::atomic<bool> readable_{false};  // a frame was
  sqlite::SavedStatistics handed_;

  std::optional<Thumbnails> thumbnails_;  // from the loop to the thread

  // Written by the thread.
  std::atomic<std::uint64_t> saved_frames_{0};
  std::atomic<std::uint64_t> saved_places_{0};
  std::atomic<std::uint64_t> saved_links_{0};
  std::uint64_t number_after_ = 0;                // the last place that is saved
  std::atomic<std::int64_t> saving_since_ns_{0};  // on the steady clock; 0: nothing is saved now
  std::atomic<bool> failing_{false};
  std::string why_;
  std::vector<Retired> retired_;
  std::vector<std::byte> bytes_;
  std::vector<sqlite::PlaceRecord> records_;
  std::vector<sqlite::SavedLink> batch_links_;
  std::vector<std::uint64_t> removed_;

  // Written by who follows; `none`: nobody does.
  std::atomic<std::uint64_t> read_places_;
  std::atomic<std::uint64_t> read_links_;
  std::vector<std::byte> newest_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;                     // under the mutex
  bool asked_ = false;                    // under the mutex: to save now
  std::vector<sqlite::SavedLink> words_;  // under the mutex: of persons, not saved yet
  std::optional<std::string> told_;       // under the mutex
  std::atomic<bool> has_told_{false};
  std::thread thread_;
};

}  // namespace seqloop::program
