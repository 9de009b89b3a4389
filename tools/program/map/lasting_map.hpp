// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "program/drives/small_picture.hpp"
#include "program/map/map_settings.hpp"
#include "program/map/place_form.hpp"
#include "program/map/place_pictures.hpp"
#include "program/map/verdict.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/frame.hpp"

namespace seqloop::program {

/// By what a session's places were standardised.
struct SessionStatistics {
  std::uint64_t frames = 0;
  std::span<const double> mean;      ///< [D]
  std::span<const double> variance;  ///< [D]
};

/// A place, as the file has it.
struct SavedPlace {
  std::int64_t began_ns = 0;  ///< when its session began, since 1970
  std::string_view session;
  std::uint64_t number = 0;
  std::uint64_t frame = 0;  ///< of the session
  std::int64_t time_ns = 0;
  std::span<const std::byte> bytes{};
  /// Nothing new, and no bytes: it is a visit of the place of this number.
  std::optional<std::uint64_t> visits = {};
  /// No place: what is known of its session by now.
  std::optional<SessionStatistics> statistics = {};
};
using SavedPlaceReader = std::function<void(const SavedPlace&)>;

/// By what the session that began then is standardised.
using StatisticsReader = std::function<void(std::int64_t began_ns, const SessionStatistics&)>;

/// A map in a file, for one run: loaded before it, saved while it goes.
class LastingMap {
 public:
  LastingMap() = default;
  LastingMap(const LastingMap&) = delete;
  LastingMap& operator=(const LastingMap&) = delete;
  LastingMap(LastingMap&&) = delete;
  LastingMap& operator=(LastingMap&&) = delete;
  virtual ~LastingMap() = default;

  /// Places that the file holds.
  [[nodiscard]] virtual std::size_t places() const noexcept = 0;

  /// Room that is needed for them, and for a drive. @param drive places that it adds at most
  [[nodiscard]] virtual Capacity capacity(std::size_t drive) const noexcept = 0;

  /// Fills an empty map, with progress. Throws SetupError: damaged.
  virtual void load(PlaceMap& map) = 0;

  [[nodiscard]] virtual PlaceForm form() const = 0;

  /// When each session of the file began.
  [[nodiscard]] virtual std::vector<std::int64_t> begun() const = 0;

  /// Places of the file, as it is now. Any thread. Throws SetupError.
  /// @param most of the newest so many sessions that have places
  virtual void read_saved(std::size_t most, const SavedPlaceReader& read) const = 0;

  /// Somebody follows the drive: to be called before `begin`. From then on `read_newest` is to be
  /// called again and again, since a full map forgets no place before that.
  /// @param learnt told of the drive's statistics each time that they are saved, by the thread that
  ///   saves; does not throw, and does not wait
  virtual void follow(StatisticsReader learnt) = 0;

  /// The drive's places, and which are visits of another, that have come since the last call: as
  /// they will be saved, whether or not the disk has them yet. For one thread, not the loop's.
  virtual void read_newest(const SavedPlaceReader& read) = 0;

  /// Ends the saving.
  struct Ending {
    void operator()(LastingMap* map) const noexcept { map->end(); }
  };
  /// As long as it is there, what the drive adds is saved.
  using Saving = std::unique_ptr<LastingMap, Ending>;

  /// The drive begins: from here on it is saved, unless the map is only read.
  /// @param map the detector's; it lives longer than what is returned. Throws SetupError.
  [[nodiscard]] Saving begin(const PlaceMap& map, const MatcherConfig& config,
                             const std::string& method) {
    start(map, config, method);
    return Saving(this);
  }

  /// What the detector has made of a frame that it has just taken.
  /// @param counted the frame, as the detector counts; @param index as its source does
  /// @param image its picture, where there is one
  /// @param readable whether it has a descriptor that is not blank; until one has, nothing is saved
  /// Allocates: never; no system call, but where `MapSettings::waits` says so.
  virtual void note(Detector& detector, std::uint64_t counted, std::uint64_t index, double time_s,
                    const Image& image, std::span<const Answer> answers,
                    bool readable) noexcept = 0;

  /// The drive is over: saves the rest, however long that takes.
  /// @return what could not be saved, or that its log has to stay beside the map, and why; nothing
  ///   where all is in the file
  [[nodiscard]] virtual std::optional<std::string> finish(Detector& detector,
                                                          std::span<const Answer> rest) = 0;

  /// Instead of `finish`: nothing of the drive stays. A full map has lost the places that went for
  /// it, if one of its frames was readable.
  /// Throws std::runtime_error: something stays, since the disk does not take it.
  virtual void discard() = 0;

  /// What there is to say of the disk, once. Never waits.
  [[nodiscard]] virtual std::optional<std::string> trouble() = 0;

  /// Frames of the drive, from the first on, that are on the disk for good. Never waits.
  [[nodiscard]] virtual std::uint64_t saved() const noexcept = 0;

  /// A drive of the map. Oldest first; this run's is the last, unless the map is only read.
  struct Session {
    std::string name;
    std::uint64_t first = 0;  ///< number of its first place, or of the one that it will have
  };
  /// Those with places. To be called by the loop's thread, after `begin`.
  [[nodiscard]] virtual std::vector<Session> sessions() const = 0;

  /// Saves at once what is noted, in the thread that saves. From any thread but the loop's.
  /// @return false where nothing is saved: the map is only read, or the drive is over
  virtual bool save_now() = 0;

  /// Keeps a person's word on an answer. From any thread but the loop's.
  /// @param frame as its source counts @param place the number of the place it was matched with
  /// @return as `save_now`
  virtual bool judge(std::uint64_t frame, std::uint64_t place, Verdict verdict) = 0;

  /// Where a place was seen.
  struct Seen {
    std::string_view session;
    std::optional<std::uint64_t> frame;  ///< of it, as its source counts; none: forgotten since
  };
  /// @param number of a place that the map has or had
  [[nodiscard]] virtual Seen where(std::uint64_t number) const = 0;

  /// Pictures of its places, as far as they are saved; may be asked after the map has gone.
  [[nodiscard]] virtual std::unique_ptr<PlacePictures> pictures() const = 0;

  /// Says in what `run` says of a frame how much is saved, and of which session places are.
  virtual void add_to(nlohmann::ordered_json& frame) const = 0;

  /// What was added, for a summary.
  [[nodiscard]] virtual std::string summary() const = 0;

 private:
  virtual void start(const PlaceMap& map, const MatcherConfig& config,
                     const std::string& method) = 0;
  virtual void end() noexcept = 0;
};

/// @param describer what describes the drive: only what was described alike can be compared
/// @param encode makes thumbnails, where the settings want any; null: there are no pictures
/// Throws SetupError, also where this build has no maps in files.
[[nodiscard]] std::unique_ptr<LastingMap> open_map(const MapSettings& settings,
                                                   const MatcherConfig& config,
                                                   std::size_t descriptor_size,
                                                   std::string describer,
                                                   JpegEncoder encode = nullptr);

}  // namespace seqloop::program
