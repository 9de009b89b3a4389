// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "seqloop/place_map.hpp"

namespace seqloop::sqlite {

/// Bytes of a place that can be saved.
constexpr std::uint64_t most_place_bytes = std::uint64_t{1} << 26U;

/// Numbers of places and of frames end below it.
constexpr std::uint64_t number_end = PlaceMap::number_end;

/// What all places of a map have in common: only such places can be compared.
struct MapForm {
  std::string form;       ///< how a place is kept, in the caller's words: "int8 euclidean"
  std::string describer;  ///< fingerprint of the model and its settings that made the descriptors
  std::uint64_t descriptor_size = 0;  ///< D
  std::uint64_t place_bytes = 0;      ///< of each place, 1 .. most_place_bytes

  bool operator==(const MapForm&) const = default;
};

/// A stretch of driving: its places follow each other.
struct SessionFacts {
  std::int64_t id = 0;        ///< 1, 2, …; never given again
  std::string name;           ///< of no other session of this map
  std::int64_t began_ns = 0;  ///< since 1970
  std::string settings;       ///< text of the caller
  std::uint64_t frames = 0;   ///< how many frames, from its first on, are saved for good
  std::uint64_t places = 0;   ///< as far as they were not removed
  bool statistics = false;    ///< whether any were saved
};

/// By what the places of a session were standardised.
struct SavedStatistics {
  std::uint64_t frames = 0;
  std::vector<double> mean;      ///< [D]
  std::vector<double> variance;  ///< [D]

  bool operator==(const SavedStatistics&) const = default;
};

/// What is known of one place beside its bytes.
struct PlaceRecord {
  std::uint64_t number = 0;  ///< in the map; never given again, below `number_end`
  std::uint64_t frame = 0;   ///< of its session, as its source counts: those that were lost, too
  std::int64_t time_ns = 0;  ///< of that frame, in the session's own clock

  bool operator==(const PlaceRecord&) const = default;
};

/// Whether a place can stand behind another one of its session: a run takes no other.
[[nodiscard]] inline bool can_follow(const PlaceRecord& place, const PlaceRecord& before) noexcept {
  return place.number > before.number && place.frame > before.frame;
}

/// Where a person has said something of a visit, that stands for its probability; the last word
/// counts.
inline constexpr double person_accepted = 2.0;
inline constexpr double person_rejected = -1.0;
inline constexpr double person_silent = 0.0;  ///< what was said before is taken back

/// A frame was at a place that the map had already.
struct SavedLink {
  std::int64_t session = 0;
  std::uint64_t frame = 0;
  std::optional<std::uint64_t> place;  ///< what the frame became itself; nothing for a visit
  std::uint64_t other = 0;             ///< the place that it was at; may be removed meanwhile
  double probability = 0.0;

  bool operator==(const SavedLink&) const = default;
};

/// Whether the frame became no place of its own; a person's word is no visit.
[[nodiscard]] inline bool is_visit(const SavedLink& link) noexcept {
  return !link.place && link.probability > person_silent && link.probability < person_accepted;
}

/// A place that another one stands for, since both show the same.
struct Successor {
  std::uint64_t place = 0;
  std::uint64_t by = 0;      ///< a place that stays
  double probability = 0.0;  ///< that they are one
};

struct SavedThumbnail {
  std::uint64_t place = 0;
  std::vector<std::byte> jpeg;

  bool operator==(const SavedThumbnail&) const = default;
};

/// How many thumbnails there are, and how much they take.
struct ThumbnailFacts {
  std::uint64_t count = 0;
  std::uint64_t bytes = 0;  ///< of JPEG
};

/// What is saved at once: all of it or nothing.
struct MapBatch {
  std::uint64_t frames = 0;  ///< of the session are dealt with, these among them; never fewer again
  std::span<const PlaceRecord> records{};        ///< new places; each can follow the one before it
  std::span<const std::byte> places{};           ///< [records * place_bytes]
  std::span<const SavedLink> links{};            ///< `session` is not looked at
  std::span<const SavedThumbnail> thumbnails{};  ///< the first one of a place stays
  std::span<const std::uint64_t> removed{};      ///< places that go; unknown ones are left out
  const SavedStatistics* statistics = nullptr;   ///< nothing: as they were
};

/// Places that follow each other in a session, as `read` hands them over.
struct PlaceBlock {
  std::int64_t session = 0;
  std::span<const PlaceRecord> records;  ///< numbers ascend
  std::span<const std::byte> places;     ///< [records * place_bytes]
};

/// A save that failed while running; what was saved before is safe, and the same call may be tried
/// again. `what()` is `WHAT: WHY; REMEDY`.
class SaveError : public std::runtime_error {
 public:
  using runtime_error::runtime_error;
};

/// For a file that is to become a map: what lies beside its name must not be of a map that was
/// moved or removed alone, since it may hold what was saved last. Nothing is looked at where there
/// is a file that has anything. Throws SetupError: it is the log or the journal of such a map.
void check_nothing_is_left_of_another(const std::filesystem::path& path);

/// What may lie beside such a file after that, as of a map whose making was cut short, goes: SQLite
/// would take it for its own. Nobody may write the file.
void remove_what_is_left(const std::filesystem::path& path) noexcept;

/// A map of many sessions in one SQLite database; README.md here has its schema.
///
/// One process at a time may write; others read meanwhile, and see what was saved when they
/// began to. What `save` returned from survives a killed process and cut power at any moment. A
/// file that is not open is one file; while it is written, and after a kill, `FILE-wal` belongs to
/// it. Open a file once in a process. Not for several threads at once. Allocates freely.
class MapFile {
 public:
  /// Opens a map to read. Where its writer was killed while it rewrote the file, the journal beside
  /// that makes it what it was before; nothing else is written.
  /// Throws SetupError: no such file, no map, of a newer version, damaged, or it would have to be
  /// made what it was and must not be written.
  [[nodiscard]] static MapFile read_only(const std::filesystem::path& path);

  /// Opens a map to write; a file that is missing or empty becomes one, and one that holds
  /// nothing takes another form.
  /// @param form of what is to be saved; nothing: as the map's is, which must exist
  /// Throws SetupError as `read_only`, and: held by another process (which, on which machine), not
  /// writable, of another form; as `check_nothing_is_left_of_another`.
  [[nodiscard]] static MapFile open(const std::filesystem::path& path,
                                    const std::optional<MapForm>& form);

  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  MapFile(const MapFile&) = delete;
  MapFile& operator=(const MapFile&) = delete;
  ~MapFile();

  /// A file that `open` made goes again if it has no session in the end.
  void drop_if_unused() noexcept;

  [[nodiscard]] const std::filesystem::path& path() const noexcept;
  [[nodiscard]] const MapForm& form() const noexcept;

  /// Whether no session has a frame, a place or statistics: all were forgotten, or whoever began
  /// them was killed. Nothing has the map's form then. Throws SetupError: damaged.
  [[nodiscard]] bool holds_nothing() const;

  /// All sessions, oldest first. Throws SetupError: damaged.
  [[nodiscard]] std::vector<SessionFacts> sessions() const;

  /// The number that the next place gets, at least. Numbers of places that went are not used again.
  [[nodiscard]] std::uint64_t next_place() const;

  /// All places, the oldest first, block after block; each block's checksum is looked at.
  /// @param take what it is given is valid during the call; how far it is, is the caller's sum
  /// @param damaged told of each damaged block, which is left out; nothing: SetupError
  /// Work: the whole file, once. Throws SetupError: damaged.
  void read(const std::function<void(const PlaceBlock&)>& take,
            const std::function<void(const std::string&)>& damaged = {}) const;

  /// Nothing when none was saved. Throws SetupError: damaged.
  [[nodiscard]] std::optional<SavedStatistics> statistics(std::int64_t session) const;
  /// All of them, in the order in which they were saved. Throw SetupError: damaged.
  void read_links(const std::function<void(const SavedLink&)>& take) const;
  void read_thumbnails(const std::function<void(const SavedThumbnail&)>& take) const;
  [[nodiscard]] std::optional<SavedThumbnail> thumbnail(std::uint64_t place) const;
  /// Places that have a thumbnail, in order: the nearest to this one, with the one before and the
  /// one after it; fewer at the ends. Throws SetupError: damaged.
  [[nodiscard]] std::vector<std::uint64_t> thumbnails_around(std::uint64_t place) const;
  /// Work: the table of thumbnails, without checksums. Throws SetupError: damaged.
  [[nodiscard]] ThumbnailFacts thumbnail_facts() const;

  /// Everything that is wrong with the file, as far as it can be told: every row's checksum, sums,
  /// of each session the first place that cannot follow the one before it, and SQLite's own
  /// structure. Empty: nothing. Work: the whole file, twice.
  [[nodiscard]] std::vector<std::string> check() const;

  /// Begins a session.
  /// @return its id. Throws SetupError: the name is taken or empty; SaveError.
  std::int64_t begin_session(const std::string& name, std::int64_t began_ns,
                             const std::string& settings);

  /// Saves a batch. When this returns, it survives cut power. May take as long as the disk does.
  /// @param session the newest one gives numbers from `next_place` on. An earlier one may grow as
  ///   well where there is room: above its places' numbers, and below those of all later sessions
  /// Throws SaveError: disk full, not writable, …: nothing of it is saved, the map is as before.
  /// std::invalid_argument: another session; bytes, places or statistics that do not fit; numbers
  /// from `number_end` on, a probability that is NaN.
  void save(std::int64_t session, const MapBatch& batch);

  /// Removes a session with its places, thumbnails and links, and all visits of it. Other places
  /// keep their numbers, and their links to places of it, which say which of them are one place.
  /// Throws SetupError: no such name; SaveError.
  void forget(const std::string& session);

  /// Removes places of a session that follow each other, with their thumbnails and links. The
  /// session stays, and of its frames visits of the places that stand for theirs; visits that led
  /// to its places lead to those, too. Links of other places to these stay, as in `forget`.
  /// @param first, last numbers of the places that go, both included
  /// @param successors of them, rising; those that have none leave no visit
  /// @param every frames that one visit is for, 1 or more: that of the first of them is kept
  /// @return visits that are kept. Throws SetupError: no such name, damaged; SaveError;
  ///   std::invalid_argument: `every` is 0.
  std::size_t retire(const std::string& session, std::uint64_t first, std::uint64_t last,
                     std::span<const Successor> successors, std::uint64_t every);

  /// Copies all sessions of another map behind this one's. A name that is taken gets a number.
  /// @return what is added to its places' numbers. Throws SetupError: another form, damaged, places
  ///   that cannot follow each other; SaveError. All of it or nothing
  std::uint64_t add(const MapFile& from);

  /// Moves what the log beside the file holds into the file, as far as nobody reads it just now.
  /// The destructor does so, too, but nobody learns that it could not. Throws SaveError: disk full,
  /// …: nothing is lost, but the log stays, and the file is no map without it.
  void checkpoint();

  /// Packs what is left, and gives the rest back to the disk. Needs as much room again meanwhile.
  /// Throws SetupError: damaged; SaveError.
  void compact();

 private:
  struct State;
  explicit MapFile(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace seqloop::sqlite
