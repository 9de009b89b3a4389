// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "sqlite/little_endian.hpp"
#include "sqlite/pages_ahead.hpp"
#include "sqlite/state.hpp"

namespace seqloop::sqlite {
namespace {

/// No number is above it.
constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();

constexpr const char* session_columns =
    "SELECT id, name, began_ns, settings, frames, places, statistics, form, describer, "
    "descriptor_size, place_bytes, checksum FROM session ";

SessionFacts session_facts(const Statement& row) {
  return {row.integer(0),
          row.text(1),
          row.integer(2),
          row.text(3),
          static_cast<std::uint64_t>(row.integer(4)),
          static_cast<std::uint64_t>(row.integer(5)),
          row.integer(6) != 0};
}

SavedThumbnail thumbnail_of(const Statement& row) {
  const std::span<const std::byte> jpeg = row.blob(1);
  return {static_cast<std::uint64_t>(row.integer(0)), {jpeg.begin(), jpeg.end()}};
}

/// Those of some numbers that lie within a block's.
/// @param numbers sorted @param row whole
std::span<const std::int64_t> among(std::span<const std::int64_t> numbers, const BlockRow& row) {
  const auto last = static_cast<std::int64_t>(load_u64(row.records.last(record_bytes)));
  const auto begin = std::ranges::lower_bound(numbers, row.first);
  return {begin, std::ranges::upper_bound(begin, numbers.end(), last)};
}

bool is_whole(const SavedThumbnail& picture, std::int64_t checksum) {
  return row_checksum("thumbnail", static_cast<std::int64_t>(picture.place),
                      std::span<const std::byte>(picture.jpeg)) == checksum;
}

/// What of a block is left, packed.
class Kept {
 public:
  explicit Kept(std::size_t place_bytes) : place_bytes_(place_bytes) {}

  /// @param removed sorted
  PlaceBlock of(const BlockRow& row, std::span<const std::int64_t> removed) {
    records_ = decode_records(row.records);
    const auto gone = [&removed](const PlaceRecord& record) {
      return std::ranges::binary_search(removed, static_cast<std::int64_t>(record.number));
    };
    if (removed.empty() || std::ranges::none_of(records_, gone)) {
      return {row.session, records_, row.places};
    }
    places_.clear();
    std::size_t left = 0;
    for (std::size_t i = 0; i < records_.size(); ++i) {
      if (gone(records_[i])) continue;
      records_[left++] = records_[i];
      const std::span<const std::byte> place = row.places.subspan(i * place_bytes_, place_bytes_);
      places_.insert(places_.end(), place.begin(), place.end());
    }
    records_.resize(left);
    return {row.session, records_, places_};
  }

 private:
  std::size_t place_bytes_;
  std::vector<PlaceRecord> records_;
  std::vector<std::byte> places_;
};

}  // namespace

BlockRow block_row(const Statement& statement) {
  return {statement.integer(0), statement.integer(1), statement.integer(2),
          statement.integer(3), statement.blob(4),    statement.blob(5)};
}

SessionFacts MapFile::State::session(std::int64_t id) const {
  Statement row(database, std::string(session_columns) + "WHERE id = ?");
  if (!row.with(id).step()) throw SetupError(damaged("session " + std::to_string(id)));
  SessionFacts facts = session_facts(row);
  if (session_sum(facts, form) != row.integer(11)) throw SetupError(damaged(session_name(id)));
  return facts;
}

std::vector<SessionFacts> MapFile::State::sessions() const {
  std::vector<SessionFacts> all;
  Statement row(database, std::string(session_columns) + "ORDER BY id");
  while (row.next()) {
    all.push_back(session_facts(row));
    if (session_sum(all.back(), form) != row.integer(11)) {
      throw SetupError(damaged(session_name(all.back().id)));
    }
  }
  return all;
}

std::string MapFile::State::session_name(std::int64_t id) const {
  try {
    Statement row(database, "SELECT name FROM session WHERE id = ?");
    if (row.with(id).step()) return "session '" + row.text(0) + "'";
  } catch (const DatabaseError&) {  // then its number has to do
  }
  return "session " + std::to_string(id);
}

void MapFile::State::each_row(std::int64_t from, std::int64_t to, const TakeRow& take) const {
  Statement rows(database, std::string(block_columns) +
                               "FROM block WHERE first BETWEEN ? AND ? ORDER BY first");
  rows.with(from, to);
  while (rows.next()) {
    const BlockRow row = block_row(rows);
    if (!take({row, row.whole(form)})) return;
  }
}

std::vector<std::int64_t> MapFile::State::removed_of(std::int64_t from, std::int64_t to,
                                                     const Tell& tell) const {
  std::vector<std::int64_t> removed;
  Statement next(database, "SELECT min(first) FROM block WHERE first > ?");
  const bool more = next.with(to).step() && !next.null(0);
  Statement gone(
      database,
      "SELECT place, checksum FROM removed WHERE place >= ? AND place < ? ORDER BY place");
  gone.with(from, more ? next.integer(0) : any);
  while (gone.next()) {
    if (row_checksum("removed", gone.integer(0)) == gone.integer(1)) {
      removed.push_back(gone.integer(0));
    } else {
      tell("the note that place " + std::to_string(gone.integer(0)) + " was removed");
    }
  }
  return removed;
}

void MapFile::State::read(std::int64_t from, std::int64_t to, const GiveRows& rows,
                          const TakeBlock& take, const Tell& told) const {
  const auto tell = [&](const std::string& what) {
    if (!told) throw SetupError(damaged(what));
    told(what);
  };
  const auto attempt = [&](const auto& what, const auto& part) {
    try {
      part();
    } catch (const DatabaseError& error) {
      if (!told || error.primary() != SQLITE_CORRUPT) throw SetupError(fault_of(path, error));
      tell(what());
    }
  };
  std::vector<std::int64_t> removed;
  attempt([] { return "the table of removed places"; },
          [&] { removed = removed_of(from, to, tell); });
  Kept kept(static_cast<std::size_t>(form.place_bytes));
  std::vector<BlockRow> wrong;  // told of at the end: until then another thread may be reading
  std::optional<std::int64_t> newest;
  const auto take_row = [&](const ReadRow& read) {
    const BlockRow& row = read.row;
    newest = row.first;
    if (!read.whole) {
      wrong.push_back(row);
      return static_cast<bool>(told);
    }
    const PlaceBlock block = kept.of(row, among(removed, row));
    if (!block.records.empty()) take(block);
    return true;
  };
  const auto rest = [&newest] {
    if (!newest) return std::string("the table of blocks");
    return "what follows the block from place " + std::to_string(*newest);
  };
  attempt(rest, [&] { rows(take_row); });
  for (const BlockRow& row : wrong) {
    tell("the block from place " + std::to_string(row.first) + " of " + session_name(row.session));
  }
}

void MapFile::State::read(std::int64_t from, std::int64_t to, const TakeBlock& take) const {
  read(from, to, [&](const TakeRow& take_row) { each_row(from, to, take_row); }, take, {});
}

std::vector<SessionFacts> MapFile::sessions() const {
  return state_->reading([&] { return state_->sessions(); });
}

void MapFile::read(const std::function<void(const PlaceBlock&)>& take,
                   const std::function<void(const std::string&)>& damaged) const {
  std::uint64_t missing = 0;
  const std::vector<SessionFacts> known = sessions();
  for (const SessionFacts& facts : known) missing += facts.places;
  const auto counted = [&](const PlaceBlock& block) {
    missing -= block.records.size();
    if (!damaged && std::ranges::find(known, block.session, &SessionFacts::id) == known.end()) {
      throw SetupError(state_->damaged("the table of sessions"));
    }
    take(block);
  };
  const GiveRows rows = [this](const TakeRow& take_row) {
    RowsAhead ahead([this](const TakeRow& keep) {
      const PagesAhead pages(state_->database, state_->path);
      state_->each_row(0, any, keep);
    });
    ahead.give(take_row);
  };
  state_->read(0, any, rows, counted, damaged);
  if (missing != 0 && !damaged)
    throw SetupError(state_->damaged("the table of blocks or of removed places"));
}

std::optional<SavedStatistics> MapFile::statistics(std::int64_t session) const {
  return state_->reading([&]() -> std::optional<SavedStatistics> {
    Statement row(state_->database,
                  "SELECT frames, mean, variance, checksum FROM statistics WHERE session = ?");
    if (!row.with(session).step()) {
      if (!state_->session(session).statistics) return std::nullopt;
      throw SetupError(state_->damaged("the statistics of " + state_->session_name(session)));
    }
    const std::int64_t sum =
        row_checksum("statistics", session, row.integer(0), row.blob(1), row.blob(2));
    SavedStatistics saved{static_cast<std::uint64_t>(row.integer(0)), decode_doubles(row.blob(1)),
                          decode_doubles(row.blob(2))};
    if (sum != row.integer(3) || !fits(saved, state_->form.descriptor_size)) {
      throw SetupError(state_->damaged("the statistics of " + state_->session_name(session)));
    }
    return saved;
  });
}

void MapFile::read_links(const std::function<void(const SavedLink&)>& take) const {
  std::int64_t count = 0;
  state_->reading([&] {
    Statement row(state_->database,
                  "SELECT id, session, frame, place, other, probability, checksum FROM link "
                  "ORDER BY id");
    while (row.next()) {
      SavedLink link{row.integer(1), static_cast<std::uint64_t>(row.integer(2)), std::nullopt,
                     static_cast<std::uint64_t>(row.integer(4)), row.real(5)};
      if (!row.null(3)) link.place = static_cast<std::uint64_t>(row.integer(3));
      if (link_sum(row.integer(0), link) != row.integer(6)) {
        throw SetupError(state_->damaged("link " + std::to_string(row.integer(0))));
      }
      take(link);
      ++count;
    }
    if (count != state_->counts.links) throw SetupError(state_->damaged("the table of links"));
  });
}

void MapFile::read_thumbnails(const std::function<void(const SavedThumbnail&)>& take) const {
  std::int64_t count = 0;
  state_->reading([&] {
    Statement row(state_->database, "SELECT place, jpeg, checksum FROM thumbnail ORDER BY place");
    while (row.next()) {
      const SavedThumbnail picture = thumbnail_of(row);
      if (!is_whole(picture, row.integer(2))) {
        throw SetupError(
            state_->damaged("the thumbnail of place " + std::to_string(picture.place)));
      }
      take(picture);
      ++count;
    }
    if (count != state_->counts.thumbnails) {
      throw SetupError(state_->damaged("the table of thumbnails"));
    }
  });
}

std::optional<SavedThumbnail> MapFile::thumbnail(std::uint64_t place) const {
  return state_->reading([&]() -> std::optional<SavedThumbnail> {
    Statement row(state_->database, "SELECT place, jpeg, checksum FROM thumbnail WHERE place = ?");
    if (!row.with(static_cast<std::int64_t>(place)).step()) return std::nullopt;
    SavedThumbnail picture = thumbnail_of(row);
    if (!is_whole(picture, row.integer(2))) {
      throw SetupError(state_->damaged("the thumbnail of place " + std::to_string(place)));
    }
    return picture;
  });
}

std::vector<std::uint64_t> MapFile::thumbnails_around(std::uint64_t place) const {
  return state_->reading([&] {
    std::vector<std::int64_t> near;
    Statement before(state_->database,
                     "SELECT place FROM thumbnail WHERE place <= ? ORDER BY place DESC LIMIT 2");
    before.with(static_cast<std::int64_t>(place));
    while (before.step()) near.insert(near.begin(), before.integer(0));
    const std::size_t after_at = near.size();
    Statement after(state_->database,
                    "SELECT place FROM thumbnail WHERE place > ? ORDER BY place LIMIT 2");
    after.with(static_cast<std::int64_t>(place));
    while (after.step()) near.push_back(after.integer(0));
    // Of two before and two after, one at an end is too far.
    const auto far = [&](std::size_t at) {
      return near[at] < static_cast<std::int64_t>(place)
                 ? static_cast<std::int64_t>(place) - near[at]
                 : near[at] - static_cast<std::int64_t>(place);
    };
    std::size_t at = after_at == 0 ? 0 : after_at - 1;
    if (after_at != 0 && after_at < near.size() && far(after_at) < far(at)) at = after_at;
    std::vector<std::uint64_t> numbers;
    for (std::size_t i = at == 0 ? 0 : at - 1; i < near.size() && i <= at + 1; ++i) {
      numbers.push_back(static_cast<std::uint64_t>(near[i]));
    }
    return numbers;
  });
}

ThumbnailFacts MapFile::thumbnail_facts() const {
  return state_->reading([&] {
    ThumbnailFacts facts;
    Statement row(state_->database, "SELECT place, length(jpeg) FROM thumbnail ORDER BY place");
    while (row.next()) {
      ++facts.count;
      facts.bytes += static_cast<std::uint64_t>(row.integer(1));
    }
    return facts;
  });
}

std::vector<std::string> MapFile::check() const {
  std::vector<std::string> wrong;
  const auto look = [&wrong](const auto& part) {
    try {
      part();
    } catch (const SetupError& error) {
      for (const Fault& fault : error.faults()) wrong.push_back(fault.why);
    }
  };
  std::vector<SessionFacts> known;
  look([&] { known = sessions(); });
  std::vector<std::uint64_t> counted(known.size());
  std::vector<std::optional<PlaceRecord>> newest(known.size());
  std::vector<std::string> out_of_order(known.size());  // the first place of each session that is
  const auto look_at_order = [&](std::size_t session, const PlaceRecord& record) {
    const std::optional<PlaceRecord> before = std::exchange(newest[session], record);
    if (!before || can_follow(record, *before) || !out_of_order[session].empty()) return;
    const std::string other = "place " + std::to_string(before->number);
    out_of_order[session] = "place " + std::to_string(record.number) + " of session '" +
                            known[session].name + "' cannot follow " + other + ": its frame is " +
                            std::to_string(record.frame) + ", and that of " + other + " is " +
                            std::to_string(before->frame);
  };
  read(
      [&](const PlaceBlock& block) {
        const auto owner = std::ranges::find(known, block.session, &SessionFacts::id);
        if (owner == known.end()) {
          wrong.push_back("the block from place " + std::to_string(block.records.front().number) +
                          " belongs to no session");
          return;
        }
        const auto session = static_cast<std::size_t>(owner - known.begin());
        counted[session] += block.records.size();
        for (const PlaceRecord& record : block.records) look_at_order(session, record);
      },
      [&wrong](const std::string& what) { wrong.push_back(what + " is damaged"); });
  const bool blocks_whole = wrong.empty();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (blocks_whole && counted[i] != known[i].places) {
      wrong.push_back("session '" + known[i].name + "' has " + std::to_string(counted[i]) +
                      " places and not " + std::to_string(known[i].places));
    }
    if (!out_of_order[i].empty()) wrong.push_back(out_of_order[i]);
    look([&] { (void)statistics(known[i].id); });
  }
  look([&] { read_links([](const SavedLink&) {}); });
  look([&] { read_thumbnails([](const SavedThumbnail&) {}); });
  look([&] {
    state_->reading([&] {
      Statement row(state_->database, "PRAGMA integrity_check(20)");
      while (row.step()) {
        if (const std::string said = row.text(0); said != "ok") wrong.push_back("SQLite: " + said);
      }
    });
  });
  return wrong;
}

}  // namespace seqloop::sqlite
