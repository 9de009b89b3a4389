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

#include "program/map/lasting_map.hpp"
#include "program/map/stored_map.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {

/// Saves what a drive adds to a map, in a thread of its own. Places are in the map already: the
/// thread follows how far they are, and reads them there, so that no frame waits for the disk and
/// nothing queues up. Until a place is saved, a full map does not forget it.
class MapWriter {
 public:
  /// All of them live longer. @param every_s seconds of driving that may be unsaved
  MapWriter(StoredMap& stored, const PlaceMap& map, const MatcherConfig& config, double every_s);

  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;
  MapWriter(MapWriter&&) = delete;
  MapWriter& operator=(MapWriter&&) = delete;
  ~MapWriter();

  /// Notes what the detector has made of a frame that it has just taken.
  /// @param counted the frame, as the detector counts; @param index as its source does
  /// Work: log N and what the frame added; every few times D copies. Allocates: never. No system
  /// call, no waiting.
  void note(Detector& detector, std::uint64_t counted, std::uint64_t index, double time_s,
            std::span<const Answer> answers) noexcept;

  /// The drive is over: saves the rest, however long that takes.
  /// @param rest answers of the detector's `finish`
  /// @return why something could not be saved; nothing when all is
  [[nodiscard]] std::optional<std::string> finish(Detector& detector, std::span<const Answer> rest);

  /// Frames of the drive, from the first on, that are on the disk for good.
  [[nodiscard]] std::uint64_t saved() const noexcept {
    return saved_frames_.load(std::memory_order_acquire);
  }

  /// Places that it has added to the file.
  [[nodiscard]] std::uint64_t saved_places() const noexcept {
    return saved_places_.load(std::memory_order_acquire);
  }

  /// Saves soon. From any thread but the loop's: it may wait. @return false once the drive is over
  bool save_now();

  /// Keeps a person's word on an answer, likewise.
  bool judge(std::uint64_t frame, std::uint64_t place, LastingMap::Word word);

  /// What there is to say of the disk, once: that it refuses, or takes again. Never waits.
  [[nodiscard]] std::optional<std::string> trouble();

  /// The source's number of the frame that a place of this drive is. @param row of the map
  [[nodiscard]] std::uint64_t source_frame(std::size_t row) const noexcept {
    return source_frames_[map_->order().slot(row)];
  }

 private:
  /// A place that was added, where it is.
  struct Added {
    std::size_t slot;
    sqlite::PlaceRecord record;
  };
  /// Where a frame came from.
  struct Came {
    std::uint64_t index;
    std::int64_t time_ns;
    double probability;  // of the place that it was at; 0: of none
  };
  enum class Handing : std::uint8_t { idle, asked, ready };

  [[nodiscard]] Came& came(std::uint64_t counted) noexcept {
    return came_[static_cast<std::size_t>(counted % came_.size())];
  }
  void add_places() noexcept;
  void settle(std::uint64_t end) noexcept;
  void hand_over_statistics(const Detector& detector) noexcept;
  void work(double every_s);
  bool save(std::span<const std::uint64_t> removed);
  void save_once(std::span<const std::uint64_t> removed);
  void tell(std::string text);
  [[nodiscard]] std::size_t words();

  StoredMap* stored_;
  const PlaceMap* map_;
  std::uint64_t settled_after_;  // frames after which a place is linked to no other any more

  // Of the loop.
  std::uint64_t first_number_;                // of a place of this drive
  std::uint64_t next_number_;                 // of the place that is noted next
  std::vector<std::uint64_t> earlier_;        // numbers of places that may go
  bool stopped_ = false;                      // the thread
  std::uint64_t counted_ = 0;                 // frames
  std::uint64_t settled_ = 0;                 // places that have been
  double last_probability_ = 0.0;             // of a link
  std::vector<Came> came_;                    // [kept], a ring by frame
  std::vector<std::uint64_t> source_frames_;  // [capacity], by slot

  // Written by the loop, read by the thread up to the marks.
  std::vector<Added> added_;              // [capacity], a ring
  std::vector<sqlite::SavedLink> links_;  // [capacity], a ring: a link a place at most
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<std::uint64_t> places_noted_{0};
  std::atomic<std::uint64_t> links_noted_{0};
  std::atomic<Handing> handing_{Handing::asked};
  sqlite::SavedStatistics handed_;

  // Written by the thread.
  std::atomic<std::uint64_t> saved_frames_{0};
  std::atomic<std::uint64_t> saved_places_{0};
  std::atomic<std::uint64_t> saved_links_{0};
  bool failing_ = false;
  std::string why_;
  std::vector<std::byte> bytes_;
  std::vector<sqlite::PlaceRecord> records_;
  std::vector<sqlite::SavedLink> batch_links_;

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
