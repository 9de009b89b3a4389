// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "seqloop/sqlite/map_file.hpp"
#include "sqlite/checksum.hpp"

namespace seqloop::sqlite {

// README.md says what each column means. `file` and other programs tell a map by its id: "SeqL".
constexpr std::int64_t application_id = 0x5365714C;
constexpr std::int64_t user_version = 1;

// A batch of a second is 20 KB: of larger pages, more would be written for nothing.
constexpr int page_size = 8192;

constexpr const char* schema_sql = R"(
CREATE TABLE map(
  id INTEGER PRIMARY KEY, form TEXT NOT NULL, describer TEXT NOT NULL,
  descriptor_size INTEGER NOT NULL, place_bytes INTEGER NOT NULL,
  next_place INTEGER NOT NULL, next_session INTEGER NOT NULL,
  links INTEGER NOT NULL, thumbnails INTEGER NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE holder(id INTEGER PRIMARY KEY, pid INTEGER NOT NULL, host TEXT NOT NULL);
CREATE TABLE session(
  id INTEGER PRIMARY KEY, name TEXT NOT NULL, began_ns INTEGER NOT NULL, settings TEXT NOT NULL,
  frames INTEGER NOT NULL, places INTEGER NOT NULL, statistics INTEGER NOT NULL,
  form TEXT NOT NULL, describer TEXT NOT NULL, descriptor_size INTEGER NOT NULL,
  place_bytes INTEGER NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE statistics(
  session INTEGER PRIMARY KEY, frames INTEGER NOT NULL, mean BLOB NOT NULL,
  variance BLOB NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE block(
  first INTEGER PRIMARY KEY, session INTEGER NOT NULL, count INTEGER NOT NULL,
  checksum INTEGER NOT NULL, records BLOB NOT NULL, places BLOB NOT NULL);
CREATE TABLE removed(place INTEGER PRIMARY KEY, checksum INTEGER NOT NULL);
CREATE TABLE link(
  id INTEGER PRIMARY KEY, session INTEGER NOT NULL, frame INTEGER NOT NULL, place INTEGER,
  other INTEGER NOT NULL, probability REAL NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE thumbnail(
  place INTEGER PRIMARY KEY, jpeg BLOB NOT NULL, checksum INTEGER NOT NULL);
)";

constexpr std::size_t record_bytes = 24;
constexpr std::size_t most_block_bytes = std::size_t{4} << 20U;

/// Numbers in columns are signed.
[[nodiscard]] constexpr std::int64_t signed_of(std::uint64_t value) noexcept {
  return static_cast<std::int64_t>(value);
}

/// Places that one block takes.
[[nodiscard]] constexpr std::size_t block_places(const MapForm& form) noexcept {
  const std::size_t fit = most_block_bytes / static_cast<std::size_t>(form.place_bytes);
  return fit < 1 ? 1 : fit > 65'536 ? 65'536 : fit;
}

/// Whether statistics are of descriptors of a size; 0: it is not known.
[[nodiscard]] bool fits(const SavedStatistics& statistics, std::uint64_t descriptor_size);

// Columns as they are in the file.
[[nodiscard]] std::vector<std::byte> encode_records(std::span<const PlaceRecord> records);
[[nodiscard]] std::vector<PlaceRecord> decode_records(std::span<const std::byte> bytes);
[[nodiscard]] std::vector<std::byte> encode_doubles(std::span<const double> values);
[[nodiscard]] std::vector<double> decode_doubles(std::span<const std::byte> bytes);

/// A row of `block`, whole.
struct BlockRow {
  std::int64_t first = 0;
  std::int64_t session = 0;
  std::int64_t count = 0;
  std::int64_t checksum = 0;
  std::span<const std::byte> records;
  std::span<const std::byte> places;

  [[nodiscard]] std::int64_t sum() const noexcept {
    return row_checksum("block", first, session, count, records, places);
  }
  /// Whether it is what was saved, and fits a map of this form.
  [[nodiscard]] bool whole(const MapForm& form) const;
};

[[nodiscard]] inline std::int64_t link_sum(std::int64_t id, const SavedLink& link) noexcept {
  return row_checksum("link", id, link.session, static_cast<std::int64_t>(link.frame),
                      link.place ? static_cast<std::int64_t>(*link.place) : std::int64_t{-1},
                      static_cast<std::int64_t>(link.other), link.probability);
}

/// The form stands in each session as well as in the map: whichever is lost, it is not.
[[nodiscard]] inline std::int64_t session_sum(const SessionFacts& facts,
                                              const MapForm& form) noexcept {
  return row_checksum(
      "session", facts.id, std::string_view(facts.name), facts.began_ns,
      std::string_view(facts.settings), static_cast<std::int64_t>(facts.frames),
      static_cast<std::int64_t>(facts.places), std::int64_t{facts.statistics ? 1 : 0},
      std::string_view(form.form), std::string_view(form.describer),
      static_cast<std::int64_t>(form.descriptor_size), static_cast<std::int64_t>(form.place_bytes));
}

/// What the map counts, so that it is seen when rows are missing.
struct Counts {
  std::int64_t next_place = 0;
  std::int64_t next_session = 1;
  std::int64_t links = 0;
  std::int64_t thumbnails = 0;
};

[[nodiscard]] inline std::int64_t map_sum(const MapForm& form, const Counts& counts) noexcept {
  return row_checksum("map", std::string_view(form.form), std::string_view(form.describer),
                      static_cast<std::int64_t>(form.descriptor_size),
                      static_cast<std::int64_t>(form.place_bytes), counts.next_place,
                      counts.next_session, counts.links, counts.thumbnails);
}

}  // namespace seqloop::sqlite
