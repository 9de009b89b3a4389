// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iterator>

#include "sqlite/state.hpp"

namespace seqloop::sqlite {
namespace {

std::int64_t signed_of(std::uint64_t value) { return static_cast<std::int64_t>(value); }

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

/// @return the name, with a number behind it where it is taken
std::string free_name(const std::vector<SessionFacts>& taken, const std::string& name) {
  std::string free = name;
  for (int number = 2; std::ranges::find(taken, free, &SessionFacts::name) != taken.end();) {
    free = name + " " + std::to_string(number++);
  }
  return free;
}

}  // namespace

void MapFile::forget(const std::string& session) {
  State& map = *state_;
  const std::vector<SessionFacts> all = sessions();
  const auto found = std::ranges::find(all, session, &SessionFacts::name);
  if (found == all.end()) {
    std::string names;
    for (const SessionFacts& known : all) names += (names.empty() ? "" : ", ") + known.name;
    throw SetupError({map.path.string(), "there is no session '" + session + "'",
                      names.empty() ? "it has none" : "it has: " + names});
  }
  map.saving([&] {
    const Numbers numbers = numbers_of(map.database, found->id, map.counts.next_place);
    const auto drop = [&map](const std::string& from, const auto&... values) -> std::int64_t {
      Statement(map.database, "DELETE FROM " + from).with(values...).run();
      return sqlite3_changes(map.database.handle());
    };
    (void)drop("removed WHERE place BETWEEN ? AND ?", numbers.first, numbers.last);
    map.counts.thumbnails -=
        drop("thumbnail WHERE place BETWEEN ? AND ?", numbers.first, numbers.last);
    // Links of other sessions to its places stay: they say which of theirs are visits of one place.
    map.counts.links -= drop("link WHERE session = ?", found->id);
    (void)drop("block WHERE session = ?", found->id);
    (void)drop("statistics WHERE session = ?", found->id);
    (void)drop("session WHERE id = ?", found->id);
  });
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
      from.state_->read(numbers.first, numbers.last,
                        [&](const PlaceBlock& block) {
                          records.assign(block.records.begin(), block.records.end());
                          for (PlaceRecord& record : records) record.number += added;
                          save(id, {.records = records, .places = block.places});
                        },
                        {});
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
  map.saving([&] {
    std::vector<std::int64_t> blocks;
    Statement rows(map.database, "SELECT first FROM block ORDER BY first");
    while (rows.step()) blocks.push_back(rows.integer(0));
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
      map.read(first, first,
               [&](const PlaceBlock& block) {
                 if (block.session != session || records.size() + block.records.size() > most)
                   write();
                 session = block.session;
                 records.insert(records.end(), block.records.begin(), block.records.end());
                 places.insert(places.end(), block.places.begin(), block.places.end());
                 for (const PlaceRecord& record : block.records) living.push_back(record.number);
               },
               {});
      replaced.push_back(first);
    }
    write();
    map.database.execute("DELETE FROM removed");
    Statement links(map.database, "SELECT id, other FROM link");
    std::vector<std::int64_t> loose;
    while (links.step()) {
      if (!std::ranges::binary_search(living, static_cast<std::uint64_t>(links.integer(1)))) {
        loose.push_back(links.integer(0));
      }
    }
    Statement drop(map.database, "DELETE FROM link WHERE id = ?");
    for (const std::int64_t id : loose) drop.with(id).run();
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
