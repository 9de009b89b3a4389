// SPDX-License-Identifier: MIT
#include "seqloop/sqlite/recover.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "seqloop/detail/counted.hpp"
#include "seqloop/sqlite/map_file.hpp"
#include "sqlite/database.hpp"
#include "sqlite/little_endian.hpp"
#include "sqlite/raw_rows.hpp"
#include "sqlite/schema.hpp"
#include "sqlite/state.hpp"
#include "sqlite/write_ahead_log.hpp"

namespace seqloop::sqlite {
namespace {

namespace fs = std::filesystem;
using Columns = std::vector<RawValue>;
using Type = RawValue::Type;

std::string text_of(const RawValue& value) {
  std::string text(value.bytes.size(), '\0');
  std::ranges::transform(value.bytes, text.begin(),
                         [](std::byte byte) { return std::to_integer<char>(byte); });
  return text;
}

std::uint64_t unsigned_of(const RawValue& value) {
  return static_cast<std::uint64_t>(value.integer);
}

/// Whether the columns are of these types: n(othing), i(nteger), t(ext), b(lob).
bool are(std::span<const RawValue> columns, std::string_view types) {
  return std::ranges::equal(columns, types, [](const RawValue& value, char type) {
    constexpr std::string_view letters = "nirtb";
    return letters[static_cast<std::size_t>(value.type)] == type;
  });
}

/// The most places that can follow each other.
/// @param records whose numbers ascend
std::vector<PlaceRecord> most_in_order(std::span<const PlaceRecord> records) {
  constexpr std::size_t none = ~std::size_t{0};
  // The longest rising row of frames: of each length, the end that is lowest so far.
  std::vector<std::size_t> ends;
  std::vector<std::size_t> before(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto end = std::ranges::lower_bound(ends, records[i].frame, {},
                                              [&](std::size_t at) { return records[at].frame; });
    before[i] = end == ends.begin() ? none : *std::prev(end);
    if (end == ends.end()) {
      ends.push_back(i);
    } else {
      *end = i;
    }
  }
  std::vector<PlaceRecord> kept;
  for (std::size_t at = ends.empty() ? none : ends.back(); at != none; at = before[at]) {
    kept.push_back(records[at]);
  }
  std::ranges::reverse(kept);
  return kept;
}

/// All that is whole in a damaged map; places and pictures by where they are.
class Remains {
 public:
  Remains(const fs::path& path, std::size_t page_size) : rows_(path, page_size) {
    rows_.each([this](const RawPlace& place, std::int64_t id, const Columns& columns) {
      sort(place, id, columns);
    });
  }

  struct Session {
    SessionFacts facts;
    std::map<std::int64_t, RawPlace> blocks;
    std::vector<SavedLink> links;
    std::optional<SavedStatistics> statistics;
    std::int64_t end = 0;  ///< behind its last place
  };

  std::map<std::int64_t, Session> sessions;
  std::optional<MapForm> form;
  std::optional<Counts> counted;  ///< what the map said that it has
  std::map<std::int64_t, RawPlace> thumbnails;
  std::set<std::uint64_t> removed;

  [[nodiscard]] std::size_t blocks() const {
    std::size_t count = 0;
    for (const auto& [id, session] : sessions) count += session.blocks.size();
    return count;
  }

  void read_block(const RawPlace& place, const std::function<void(const BlockRow&)>& take) {
    rows_.again(place,
                [&](const RawPlace&, std::int64_t id, const Columns& c) { take(block_of(id, c)); });
  }
  SavedThumbnail read_thumbnail(const RawPlace& place) {
    SavedThumbnail picture;
    rows_.again(place, [&](const RawPlace&, std::int64_t id, const Columns& c) {
      picture = {static_cast<std::uint64_t>(id), {c[1].bytes.begin(), c[1].bytes.end()}};
    });
    return picture;
  }

 private:
  static BlockRow block_of(std::int64_t id, const Columns& c) {
    return {id, c[1].integer, c[2].integer, c[3].integer, c[4].bytes, c[5].bytes};
  }

  void sort(const RawPlace& place, std::int64_t id, const Columns& c) {
    if (are(c, "niiibb")) {
      take_block(place, block_of(id, c));
    } else if (are(c, "ntitiiittiii")) {
      take_session(id, c);
    } else if (are(c, "nttiiiiiii")) {
      const MapForm found{text_of(c[1]), text_of(c[2]), unsigned_of(c[3]), unsigned_of(c[4])};
      const Counts counts{c[5].integer, c[6].integer, c[7].integer, c[8].integer};
      if (map_sum(found, counts) != c[9].integer) return;
      form = found;
      counted = counts;
    } else if (are(c, "nibbi")) {
      if (row_checksum("statistics", id, c[1].integer, c[2].bytes, c[3].bytes) != c[4].integer)
        return;
      sessions[id].statistics = SavedStatistics{unsigned_of(c[1]), decode_doubles(c[2].bytes),
                                                decode_doubles(c[3].bytes)};
    } else if (are(c, "nbi")) {
      if (row_checksum("thumbnail", id, c[1].bytes) == c[2].integer) thumbnails[id] = place;
    } else if (are(c, "ni")) {
      if (row_checksum("removed", id) == c[1].integer)
        removed.insert(static_cast<std::uint64_t>(id));
    } else if (c.size() == 7) {
      take_link(id, c);
    }
  }

  void take_block(const RawPlace& place, const BlockRow& row) {
    const std::uint64_t bytes =
        row.count < 1 ? 0 : row.places.size() / static_cast<std::uint64_t>(row.count);
    if (bytes < 1 || bytes > most_place_bytes || !row.whole({"", "", 0, bytes})) return;
    if (!form_of_blocks) form_of_blocks = bytes;
    Session& session = sessions[row.session];
    session.blocks[row.first] = place;
    const auto last = load_u64(row.records.last(record_bytes));
    session.end = std::max(session.end, static_cast<std::int64_t>(last) + 1);
  }

  void take_session(std::int64_t id, const Columns& c) {
    const SessionFacts facts{id,
                             text_of(c[1]),
                             c[2].integer,
                             text_of(c[3]),
                             unsigned_of(c[4]),
                             unsigned_of(c[5]),
                             c[6].integer != 0};
    const MapForm found{text_of(c[7]), text_of(c[8]), unsigned_of(c[9]), unsigned_of(c[10])};
    if (session_sum(facts, found) != c[11].integer) return;
    sessions[id].facts = facts;
    if (!form) form = found;
  }

  void take_link(std::int64_t id, const Columns& c) {
    if (!are(std::span(c).first(3), "nii") || c[4].type != Type::integer) return;
    // Whole numbers are kept as such, whatever the column.
    const double probability =
        c[5].type == Type::real ? c[5].real : static_cast<double>(c[5].integer);
    SavedLink link{c[1].integer, unsigned_of(c[2]), std::nullopt, unsigned_of(c[4]), probability};
    if (c[3].type == Type::integer) link.place = unsigned_of(c[3]);
    if (link_sum(id, link) == c[6].integer) sessions[link.session].links.push_back(link);
  }

  RawRows rows_;

 public:
  std::optional<std::uint64_t> form_of_blocks;  ///< bytes of a place, where nothing else is known
};

/// The file as it is with its log: a copy, where there is one.
class WithLog {
 public:
  WithLog(const fs::path& in, const fs::path& beside) : path_(in) {
    const auto is_used = [&in](const char* tail) {
      std::error_code error;
      const std::uintmax_t size = fs::file_size(in.string() + tail, error);
      return !error && size > 0;
    };
    if (!is_used("-wal") && !is_used("-journal")) return;
    if (has_foreign_log(in)) return;
    path_ = beside.string() + ".copy";
    copied_ = true;
    for (const char* tail : {"", "-wal", "-journal"}) {
      if (*tail != '\0' && !is_used(tail)) continue;
      fs::copy_file(in.string() + tail, path_.string() + tail,
                    fs::copy_options::overwrite_existing);
    }
    if (const fs::path log = path_.string() + "-wal"; is_damaged_log(log)) {
      put_log_into(path_, log);
      fs::remove(log);
    }
    try {
      Database database(path_, SQLITE_OPEN_READWRITE);
      (void)database.number("SELECT count(*) FROM sqlite_master");
      database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const DatabaseError&) {  // what stands in the file itself has to do
    }
  }
  WithLog(const WithLog&) = delete;
  WithLog& operator=(const WithLog&) = delete;
  WithLog(WithLog&&) = delete;
  WithLog& operator=(WithLog&&) = delete;
  ~WithLog() {
    std::error_code error;
    for (const char* tail : {"", "-wal", "-journal", "-shm"}) {
      if (copied_) fs::remove(path_.string() + tail, error);
    }
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  static bool has_foreign_log(const fs::path& path) {
    try {
      return Database(path, SQLITE_OPEN_READONLY).is_beside_foreign_log();
    } catch (const DatabaseError&) {
      return false;
    }
  }

  fs::path path_;
  bool copied_ = false;
};

class Copying {
 public:
  Copying(Remains& remains, MapFile& map, const std::function<void()>& between)
      : remains_(remains), map_(map), between_(between) {
    for (const auto& [id, session] : remains.sessions) known_.push_back(session.facts);
  }

  Recovered all() {
    for (auto& [id, session] : remains_.sessions) copy(id, session);
    if (remains_.counted) {
      miss(remains_.counted->links, result_.links, "links");
      miss(remains_.counted->thumbnails, result_.thumbnails, "thumbnails");
    }
    return std::move(result_);
  }

 private:
  /// A name that is made up takes none from the others; a row that was left of a session that is
  /// gone may have its name.
  [[nodiscard]] std::string name_of(std::int64_t id, const SessionFacts& facts) const {
    return free_name(map_.sessions(), facts.name.empty()
                                          ? free_name(known_, "recovered " + std::to_string(id))
                                          : facts.name);
  }

  void copy(std::int64_t id, Remains::Session& session) {
    const std::string name = name_of(id, session.facts);
    const std::int64_t own =
        map_.begin_session(name, session.facts.began_ns, session.facts.settings);
    ++result_.sessions;
    std::uint64_t places = 0;
    if (session.statistics && !fits(*session.statistics, map_.form().descriptor_size)) {
      session.statistics.reset();
    }
    const std::vector<PlaceRecord> kept = places_to_keep(session);
    const std::uint64_t frames =
        std::max(session.facts.frames, kept.empty() ? 0 : kept.back().frame + 1);
    for (const auto& [first, place] : session.blocks) {
      between_();
      remains_.read_block(place, [&](const BlockRow& row) {
        const std::size_t saved = copy_block(own, row, kept, frames);
        places += saved;
      });
    }
    const auto from = remains_.thumbnails.lower_bound(
        session.blocks.empty() ? session.end : session.blocks.begin()->first);
    std::vector<SavedThumbnail> pictures;
    for (auto picture = from; picture != remains_.thumbnails.end() && picture->first < session.end;
         ++picture) {
      between_();
      pictures.push_back(remains_.read_thumbnail(picture->second));
    }
    map_.save(own, {.frames = frames,
                    .links = session.links,
                    .thumbnails = pictures,
                    .statistics = session.statistics ? &*session.statistics : nullptr});
    result_.places += places;
    result_.links += session.links.size();
    result_.thumbnails += pictures.size();
    if (session.facts.name.empty()) {
      result_.lost.push_back("the name of session '" + name + "', and what else is said of it");
    } else if (places < session.facts.places) {
      result_.lost.push_back("session '" + name +
                             "': " + std::to_string(session.facts.places - places) + " of " +
                             counted(session.facts.places, "place"));
    }
    if (!session.statistics && session.facts.statistics) {
      result_.lost.push_back("session '" + name + "': its statistics");
    }
  }

  void miss(std::int64_t there_were, std::uint64_t copied, const char* what) {
    const auto all = static_cast<std::uint64_t>(std::max<std::int64_t>(there_were, 0));
    if (copied >= all) return;
    result_.lost.push_back(std::to_string(all - copied) + " of " + std::to_string(all) + " " +
                           what);
  }

  std::vector<PlaceRecord> places_to_keep(const Remains::Session& session) {
    std::vector<PlaceRecord> records;
    for (const auto& [first, place] : session.blocks) {
      remains_.read_block(place, [&](const BlockRow& row) {
        if (!row.whole(map_.form())) return;
        for (const PlaceRecord& record : decode_records(row.records)) {
          // Numbers that do not ascend are those of a row that was written anew elsewhere.
          const std::uint64_t next =
              records.empty() ? map_.next_place() : records.back().number + 1;
          if (remains_.removed.contains(record.number) || record.number < next) continue;
          records.push_back(record);
        }
      });
    }
    return most_in_order(records);
  }

  /// @return places saved
  std::size_t copy_block(std::int64_t session, const BlockRow& row,
                         const std::vector<PlaceRecord>& kept, std::uint64_t frames) {
    const auto size = static_cast<std::size_t>(map_.form().place_bytes);
    if (!row.whole(map_.form())) return 0;
    std::vector<PlaceRecord> records;
    std::vector<std::byte> bytes;
    const std::vector<PlaceRecord> all = decode_records(row.records);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::uint64_t next = records.empty() ? map_.next_place() : records.back().number + 1;
      if (!std::ranges::binary_search(kept, all[i].number, {}, &PlaceRecord::number) ||
          all[i].number < next) {
        continue;
      }
      records.push_back(all[i]);
      const std::span<const std::byte> place = row.places.subspan(i * size, size);
      bytes.insert(bytes.end(), place.begin(), place.end());
    }
    map_.save(session, {.frames = frames, .records = records, .places = bytes});
    return records.size();
  }

  Remains& remains_;
  MapFile& map_;
  const std::function<void()>& between_;
  std::vector<SessionFacts> known_;
  Recovered result_;
};

/// What the file says, or what it was written with.
std::size_t page_size_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 18> header{};
  file.read(header.data(), header.size());
  const auto byte = [&header](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(header.at(i)));
  };
  const std::size_t said = byte(16) << 8U | byte(17);
  const std::size_t size = said == 1 ? 65'536 : said;
  const bool valid = size >= 512 && (size & (size - 1)) == 0;
  return file && valid ? size : static_cast<std::size_t>(page_size);
}

}  // namespace

Recovered recover(const fs::path& in, const fs::path& out, const std::function<void()>& between) {
  const std::string name = in.string();
  if (!fs::is_regular_file(in) || !std::ifstream(in)) {
    throw SetupError({name, "there is no such map, or it must not be read", "name a map"});
  }
  if (std::error_code error; fs::exists(out, error) && fs::file_size(out, error) != 0) {
    throw SetupError({out.string(), "there is such a file already", "name a new one"});
  }
  try {
    const WithLog file(in, out);
    auto remains = std::make_unique<Remains>(file.path(), static_cast<std::size_t>(page_size));
    // What the file says of its pages may itself be damaged: what finds more is right.
    if (const std::size_t said = page_size_of(file.path()); said != page_size) {
      auto others = std::make_unique<Remains>(file.path(), said);
      if (others->blocks() > remains->blocks()) remains = std::move(others);
    }
    const bool unknown = !remains->form;
    if (unknown && remains->form_of_blocks) {
      remains->form = {"recovered", "recovered", 0, *remains->form_of_blocks};
    }
    if (!remains->form) {
      throw SetupError({name, "nothing of a map is whole in it", "take a copy, if there is one"});
    }
    between();
    MapFile map = MapFile::open(out, remains->form);
    Recovered result = Copying(*remains, map, between).all();
    map.checkpoint();
    if (unknown) result.lost.emplace_back("what described the places, and in which form they are");
    return result;
  } catch (const fs::filesystem_error& error) {
    throw SaveError(name + ": cannot be copied: " + error.code().message());
  }
}

}  // namespace seqloop::sqlite
