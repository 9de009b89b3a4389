// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iterator>

#include "sqlite/state.hpp"

namespace seqloop::sqlite {
namespace {

/// The numbers of a session's places lie between these, and no other's do.
struct Numbers {
  std::int64_t first = 0;
  std::int64_t last = -1;
};

Numbers numbers_of(const Database& database, std::int64_t session, std::int64_t end) {
  Statement own(database, "SELECT min(first) FROM block WHERE session = ?");
  if (!own.with(session).step() || own.null(0)) return {};
  const std::int64_t first = own.integer(0);
  Statement next(database, "SELECT min(first) FROM block WHERE first > ? AND session <> ?");
  next.with(first, session).step();
  return {first, (next.null(0) ? end : next.integer(0)) - 1};
}

/// Throws SetupError: there is no such session.
SessionFacts named(const MapFile& map, const std::string& session) {
  std::string names;
  for (const SessionFacts& known : map.sessions()) {
    if (known.name == session) return known;
    names += (names.empty() ? "" : ", ") + known.name;
  }
  throw SetupError({map.path().string(), "there is no session '" + session + "'",
                    names.empty() ? "it has none" : "it has: " + names});
}

/// @return rows that went
template <class State, class... Values>
std::int64_t drop(State& map, const std::string& from, const Values&... values) {
  Statement(map.database, "DELETE FROM " + from).with(values...).run();
  return sqlite3_changes(map.database.handle());
}

/// @return null where it has none
const Successor* successor_of(std::span<const Successor> successors, std::uint64_t place) {
  const auto found = std::ranges::lower_bound(successors, place, {}, &Successor::place);
  return found != successors.end() && found->place == place ? &*found : nullptr;
}

/// Visits of places that go lead to those that stand for them; a person's word stays as it was
/// said.
template <class State>
void lead_on(State& map, std::span<const Successor> successors) {
  Statement rows(
      map.database,
      "SELECT id, session, frame, other, probability FROM link WHERE place IS NULL ORDER BY id");
  std::vector<std::pair<std::int64_t, SavedLink>> changed;
  while (rows.next()) {
    SavedLink visit{rows.integer(1), static_cast<std::uint64_t>(rows.integer(2)), std::nullopt,
                    static_cast<std::uint64_t>(rows.integer(3)), rows.real(4)};
    const Successor* next = successor_of(successors, visit.other);
    if (next == nullptr || !is_visit(visit)) continue;
    visit.other = next->by;
    visit.probability = std::min(visit.probability, next->probability);
    changed.emplace_back(rows.integer(0), visit);
  }
  Statement update(map.database,
                   "UPDATE link SET other = ?, probability = ?, checksum = ? WHERE id = ?");
  for (const auto& [id, visit] : changed) {
    update.with(signed_of(visit.other), visit.probability, link_sum(id, visit), id).run();
  }
}

}  // namespace

std::string free_name(const std::vector<SessionFacts>& taken, const std::string& name) {
  std::string free = name;
  for (int number = 2; std::ranges::find(taken, free, &SessionFacts::name) != taken.end();) {
    free = name + " " + std::to_string(number++);
  }
  return free;
}

void MapFile::forget(const std::string& session) {
  State& map = *state_;
  const SessionFacts facts = named(*this, session);
  map.saving([&] {
    const Numbers numbers = numbers_of(map.database, facts.id, map.counts.next_place);
    (void)drop(map, "removed WHERE place BETWEEN ? AND ?", numbers.first, numbers.last);
    map.counts.thumbnails -=
        drop(map, "thumbnail WHERE place BETWEEN ? AND ?", numbers.first, numbers.last);
    // Links of other sessions to its places stay: they say which of theirs are visits of one place.
    // Frames of theirs that became no place were nowhere else: what they visited is forgotten.
    map.counts.links -= drop(map, "link WHERE session = ?", facts.id);
    map.counts.links -= drop(map, "link WHERE place IS NULL AND other BETWEEN ? AND ?",
                             numbers.first, numbers.last);
    (void)drop(map, "block WHERE session = ?", facts.id);
    (void)drop(map, "statistics WHERE session = ?", facts.id);
    (void)drop(map, "session WHERE id = ?", facts.id);
  });
}

std::size_t MapFile::retire(const std::string& session, std::uint64_t first, std::uint64_t last,
                            std::span<const Successor> successors, std::uint64_t every) {
  if (every == 0) throw std::invalid_argument("MapFile::retire: a visit for no frame");
  State& map = *state_;
  SessionFacts facts = named(*this, session);
  std::vector<SavedLink> visits;
  map.saving([&] {
    // Of blocks at the ends, a part stays.
    std::vector<std::int64_t> blocks;
    Statement rows(map.database, "SELECT first FROM block WHERE session = ? ORDER BY first");
    rows.with(facts.id);
    while (rows.next()) blocks.push_back(rows.integer(0));
    const Numbers numbers = numbers_of(map.database, facts.id, map.counts.next_place);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::int64_t end = i + 1 < blocks.size() ? blocks[i + 1] - 1 : numbers.last;
      if (end < signed_of(first) || blocks[i] > signed_of(last)) continue;
      std::vector<PlaceRecord> left;
      std::vector<std::byte> bytes;
      map.read(blocks[i], blocks[i], [&](const PlaceBlock& block) {
        const std::size_t size = block.places.size() / block.records.size();
        for (std::size_t at = 0; at < block.records.size(); ++at) {
          const PlaceRecord& record = block.records[at];
          if (record.number < first || record.number > last) {
            left.push_back(record);
            const auto place = block.places.subspan(at * size, size);
            bytes.insert(bytes.end(), place.begin(), place.end());
            continue;
          }
          --facts.places;
          const Successor* next = successor_of(successors, record.number);
          if (next == nullptr) continue;
          if (!visits.empty() && record.frame - visits.back().frame < every) continue;
          visits.push_back({facts.id, record.frame, std::nullopt, next->by, next->probability});
        }
      });
      (void)drop(map, "block WHERE first = ?", blocks[i]);
      (void)drop(map, "removed WHERE place BETWEEN ? AND ?", blocks[i], end);
      if (!left.empty()) map.insert_block(facts.id, left, bytes);
    }
    map.counts.thumbnails -=
        drop(map, "thumbnail WHERE place BETWEEN ? AND ?", signed_of(first), signed_of(last));
    map.counts.links -= drop(map, "link WHERE session = ? AND place BETWEEN ? AND ?", facts.id,
                             signed_of(first), signed_of(last));
    lead_on(map, successors);
    map.insert_links(facts.id, visits);
    if (facts.places == 0) {
      (void)drop(map, "statistics WHERE session = ?", facts.id);
      facts.statistics = false;
    }
    map.save_session(facts);
  });
  return visits.size();
}

std::uint64_t MapFile::add(const MapFile& from) {
  if (from.form() != form()) {
    throw SetupError({from.path().string(),
                      "its places cannot be compared with those of " + path().string(),
                      "merge maps that were made with the same settings"});
  }
  const std::uint64_t added = next_place();
  std::vector<SavedLink> links;
  from.read_links([&](SavedLink link) {
    link.other += added;
    if (link.place) *link.place += added;
    links.push_back(link);
  });
  state_->saving([&] {
    for (const SessionFacts& facts : from.sessions()) {
      const std::int64_t id =
          begin_session(free_name(sessions(), facts.name), facts.began_ns, facts.settings);
      const Numbers numbers = from.state_->reading([&] {
        return numbers_of(from.state_->database, facts.id, signed_of(from.next_place()));
      });
      std::vector<PlaceRecord> records;
      from.state_->read(numbers.first, numbers.last, [&](const PlaceBlock& block) {
        records.assign(block.records.begin(), block.records.end());
        for (PlaceRecord& record : records) record.number += added;
        try {
          save(id, {.records = records, .places = block.places});
        } catch (const std::invalid_argument&) {
          throw SetupError({from.path().string(), "its places cannot follow each other",
                            "`seqloop map check` says more"});
        }
      });
      std::vector<SavedThumbnail> pictures;
      from.read_thumbnails([&](const SavedThumbnail& picture) {
        const std::int64_t place = signed_of(picture.place);
        if (place < numbers.first || place > numbers.last) return;
        pictures.push_back(picture);
        pictures.back().place += added;
      });
      std::vector<SavedLink> own;
      std::ranges::copy_if(links, std::back_inserter(own),
                           [&](const SavedLink& link) { return link.session == facts.id; });
      const std::optional<SavedStatistics> statistics = from.statistics(facts.id);
      save(id, {.frames = facts.frames,
                .links = own,
                .thumbnails = pictures,
                .statistics = statistics ? &*statistics : nullptr});
    }
  });
  return added;
}

void MapFile::compact() {
  State& map = *state_;
  // Rows that come again and again would be written as often before SQLite is stopped.
  const bool sound =
      map.reading([&map] { return map.database.text("PRAGMA quick_check(1)") == "ok"; });
  if (!sound) throw SetupError(map.damaged("its structure"));
  map.saving([&] {
    std::vector<std::int64_t> blocks;
    Statement rows(map.database, "SELECT first FROM block ORDER BY first");
    while (rows.next()) blocks.push_back(rows.integer(0));
    std::vector<std::int64_t> replaced;
    std::vector<PlaceRecord> records;
    std::vector<std::byte> places;
    std::vector<std::uint64_t> living;
    std::int64_t session = 0;
    const auto write = [&] {
      Statement drop(map.database, "DELETE FROM block WHERE first = ?");
      for (const std::int64_t first : replaced) drop.with(first).run();
      if (!records.empty()) map.insert_block(session, records, places);
      replaced.clear();
      records.clear();
      places.clear();
    };
    const std::size_t most = block_places(map.form);
    for (const std::int64_t first : blocks) {
      map.read(first, first, [&](const PlaceBlock& block) {
        if (block.session != session || records.size() + block.records.size() > most) write();
        session = block.session;
        records.insert(records.end(), block.records.begin(), block.records.end());
        places.insert(places.end(), block.places.begin(), block.places.end());
        for (const PlaceRecord& record : block.records) living.push_back(record.number);
      });
      replaced.push_back(first);
    }
    write();
    map.database.execute("DELETE FROM removed");
    // A link of a place that is there stays, even to one that is gone: others may lead there, too.
    Statement links(map.database, "SELECT id, coalesce(place, other) FROM link ORDER BY id");
    std::vector<std::int64_t> loose;
    while (links.next()) {
      if (!std::ranges::binary_search(living, static_cast<std::uint64_t>(links.integer(1)))) {
        loose.push_back(links.integer(0));
      }
    }
    Statement unlink(map.database, "DELETE FROM link WHERE id = ?");
    for (const std::int64_t id : loose) unlink.with(id).run();
    map.counts.links -= static_cast<std::int64_t>(loose.size());
  });
  try {
    map.database.execute("VACUUM");
    map.database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  } catch (const DatabaseError& error) {
    throw SaveError(to_string(fault_of(map.path, error)));
  }
}

}  // namespace seqloop::sqlite
