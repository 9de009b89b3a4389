// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "sqlite/state.hpp"

namespace seqloop::sqlite {
namespace {

/// Throws std::invalid_argument: what of a batch does not fit.
void check_batch(const MapBatch& batch, const MapForm& form) {
  if (batch.places.size() / form.place_bytes != batch.records.size() ||
      batch.places.size() % form.place_bytes != 0) {
    throw std::invalid_argument("MapFile::save: bytes of places do not fit the records");
  }
  const PlaceRecord* before = nullptr;
  for (const PlaceRecord& record : batch.records) {
    if (record.number >= number_end || (before != nullptr && !can_follow(record, *before))) {
      throw std::invalid_argument("MapFile::save: places that cannot follow each other");
    }
    before = &record;
  }
  for (const SavedLink& link : batch.links) {
    if (std::max({link.frame, link.other, link.place.value_or(0)}) >= number_end ||
        std::isnan(link.probability)) {
      throw std::invalid_argument("MapFile::save: a link with a number or probability of none");
    }
  }
  const auto is_none = [](std::uint64_t number) { return number >= number_end; };
  if (std::ranges::any_of(batch.thumbnails, is_none, &SavedThumbnail::place) ||
      batch.frames >= number_end) {
    throw std::invalid_argument("MapFile::save: a number that none has");
  }
  if (batch.statistics != nullptr && !fits(*batch.statistics, form.descriptor_size)) {
    throw std::invalid_argument("MapFile::save: statistics do not fit the descriptors");
  }
}

}  // namespace

void MapFile::State::save_session(const SessionFacts& facts) {
  Statement(database, "INSERT OR REPLACE INTO session VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .with(facts.id, std::string_view(facts.name), facts.began_ns,
            std::string_view(facts.settings), signed_of(facts.frames), signed_of(facts.places),
            std::int64_t{facts.statistics ? 1 : 0}, std::string_view(form.form),
            std::string_view(form.describer), signed_of(form.descriptor_size),
            signed_of(form.place_bytes), session_sum(facts, form))
      .run();
}

void MapFile::State::check_numbers(std::int64_t session, const PlaceRecord& first_place,
                                   std::uint64_t last) const {
  const std::uint64_t first = first_place.number;
  bool fits = session >= 1 && session < counts.next_session;
  // The newest session's are above all that were ever given.
  if (session + 1 == counts.next_session) fits = signed_of(first) >= counts.next_place;
  Statement before(database,
                   "SELECT session, records FROM block WHERE first <= ? ORDER BY first DESC "
                   "LIMIT 1");
  if (before.with(signed_of(first)).step()) {
    const std::vector<PlaceRecord> records = decode_records(before.blob(1));
    fits = fits && before.integer(0) <= session && !records.empty() &&
           (before.integer(0) < session ? records.back().number < first
                                        : can_follow(first_place, records.back()));
  }
  Statement behind(database,
                   "SELECT session, first FROM block WHERE first > ? ORDER BY first LIMIT 1");
  if (behind.with(signed_of(first)).step()) {
    fits = fits && behind.integer(0) > session && behind.integer(1) > signed_of(last);
  }
  if (!fits) {
    throw std::invalid_argument(
        "MapFile::save: places cannot follow those that are there, or others have their numbers");
  }
}

void MapFile::State::insert_block(std::int64_t session, std::span<const PlaceRecord> records,
                                  std::span<const std::byte> places) {
  const std::vector<std::byte> coded = encode_records(records);
  const BlockRow row{
      signed_of(records.front().number), session, signed_of(records.size()), 0, coded, places};
  Statement(database, "INSERT INTO block VALUES(?, ?, ?, ?, ?, ?)")
      .with(row.first, row.session, row.count, row.sum(), row.records, row.places)
      .run();
}

void MapFile::State::remove_place(std::int64_t number) {
  // Not the places: a block may have 4 MB of them, and most removals do without.
  Statement find(database,
                 "SELECT first, session, records FROM block WHERE first <= ? "
                 "ORDER BY first DESC LIMIT 1");
  if (!find.with(number).step()) return;
  const std::int64_t first = find.integer(0);
  const std::int64_t owner_id = find.integer(1);
  if (find.blob(2).size() % record_bytes != 0 || find.blob(2).empty()) return;
  const std::vector<PlaceRecord> records = decode_records(find.blob(2));
  const auto is_it = [number](const PlaceRecord& r) { return signed_of(r.number) == number; };
  if (std::ranges::none_of(records, is_it)) return;
  Statement(database, "INSERT OR IGNORE INTO removed VALUES(?, ?)")
      .with(number, row_checksum("removed", number))
      .run();
  if (sqlite3_changes(database.handle()) == 0) return;
  SessionFacts owner = session(owner_id);
  --owner.places;
  save_session(owner);
  Statement(database, "DELETE FROM thumbnail WHERE place = ?").with(number).run();
  counts.thumbnails -= sqlite3_changes(database.handle());

  // Half empty blocks are written anew: the file stays within twice of what it holds, and each
  // place is copied about once.
  const std::int64_t last = signed_of(records.back().number);
  Statement gone_rows(database,
                      "SELECT place FROM removed WHERE place BETWEEN ? AND ? ORDER BY place");
  gone_rows.with(first, last);
  std::vector<std::int64_t> gone;
  while (gone_rows.next()) gone.push_back(gone_rows.integer(0));
  if (gone.size() * 2 < records.size()) return;
  find.with(std::int64_t{-1});
  Statement whole(database, std::string(block_columns) + "FROM block WHERE first = ?");
  (void)whole.with(first).step();
  const BlockRow row = block_row(whole);
  if (!row.whole(form)) throw SetupError(damaged("the block from place " + std::to_string(first)));
  std::vector<PlaceRecord> left;
  std::vector<std::byte> bytes;
  const auto size = static_cast<std::size_t>(form.place_bytes);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (std::ranges::binary_search(gone, signed_of(records[i].number))) continue;
    left.push_back(records[i]);
    const std::span<const std::byte> place = row.places.subspan(i * size, size);
    bytes.insert(bytes.end(), place.begin(), place.end());
  }
  whole.with(std::int64_t{-1});
  Statement(database, "DELETE FROM block WHERE first = ?").with(first).run();
  Statement(database, "DELETE FROM removed WHERE place BETWEEN ? AND ?").with(first, last).run();
  if (!left.empty()) insert_block(owner.id, left, bytes);
}

void MapFile::State::insert_links(std::int64_t session, std::span<const SavedLink> links) {
  if (links.empty()) return;
  Statement insert(database, "INSERT INTO link VALUES(?, ?, ?, ?, ?, ?, ?)");
  counts.links += signed_of(links.size());
  std::int64_t id = database.number("SELECT max(id) FROM link");
  for (SavedLink link : links) {
    link.session = session;
    std::optional<std::int64_t> place;
    if (link.place) place = signed_of(*link.place);
    ++id;
    insert
        .with(id, session, signed_of(link.frame), place, signed_of(link.other), link.probability,
              link_sum(id, link))
        .run();
  }
}

std::int64_t MapFile::begin_session(const std::string& name, std::int64_t began_ns,
                                    const std::string& settings) {
  const std::string file = state_->path.string();
  if (name.empty()) throw SetupError({file, "a session without a name", "give it one"});
  for (const SessionFacts& known : sessions()) {
    if (known.name != name) continue;
    throw SetupError({file, "there is a session '" + name + "' already", "give another name"});
  }
  // A drive's thumbnails come last: damage there would be met when its places are saved with them.
  (void)thumbnails_around(static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
  const std::int64_t id = state_->counts.next_session;
  state_->saving([&] {
    state_->save_session({id, name, began_ns, settings, 0, 0, false});
    state_->counts.next_session = id + 1;
  });
  return id;
}

void MapFile::save(std::int64_t session, const MapBatch& batch) {
  State& map = *state_;
  check_batch(batch, map.form);
  if (!batch.records.empty()) {
    map.check_numbers(session, batch.records.front(), batch.records.back().number);
  } else if (session < 1 || session >= map.counts.next_session) {
    throw std::invalid_argument("MapFile::save: no such session");
  }
  map.saving([&] {
    SessionFacts facts = map.session(session);
    const std::size_t at_once = block_places(map.form);
    const auto size = static_cast<std::size_t>(map.form.place_bytes);
    for (std::size_t i = 0; i < batch.records.size(); i += at_once) {
      const std::size_t count = std::min(at_once, batch.records.size() - i);
      map.insert_block(session, batch.records.subspan(i, count),
                       batch.places.subspan(i * size, count * size));
    }
    if (!batch.records.empty()) {
      map.counts.next_place =
          std::max(map.counts.next_place, signed_of(batch.records.back().number) + 1);
    }
    map.insert_links(session, batch.links);
    if (!batch.thumbnails.empty()) {
      Statement insert(map.database, "INSERT OR IGNORE INTO thumbnail VALUES(?, ?, ?)");
      for (const SavedThumbnail& picture : batch.thumbnails) {
        const std::span<const std::byte> jpeg = picture.jpeg;
        const std::int64_t place = signed_of(picture.place);
        insert.with(place, jpeg, row_checksum("thumbnail", place, jpeg)).run();
        map.counts.thumbnails += sqlite3_changes(map.database.handle());
      }
    }
    facts.frames = std::max(facts.frames, batch.frames);
    facts.places += batch.records.size();
    facts.statistics = facts.statistics || batch.statistics != nullptr;
    map.save_session(facts);
    for (const std::uint64_t number : batch.removed) map.remove_place(signed_of(number));
    if (batch.statistics != nullptr) {
      const std::vector<std::byte> mean = encode_doubles(batch.statistics->mean);
      const std::vector<std::byte> variance = encode_doubles(batch.statistics->variance);
      const std::span<const std::byte> means = mean;
      const std::span<const std::byte> variances = variance;
      const std::int64_t frames = signed_of(batch.statistics->frames);
      Statement(map.database, "INSERT OR REPLACE INTO statistics VALUES(?, ?, ?, ?, ?)")
          .with(session, frames, means, variances,
                row_checksum("statistics", session, frames, means, variances))
          .run();
    }
  });
}

}  // namespace seqloop::sqlite
