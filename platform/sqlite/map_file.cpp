// SPDX-License-Identifier: MIT
#include "seqloop/sqlite/map_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "sqlite/rollback_journal.hpp"
#include "sqlite/state.hpp"
#include "sqlite/write_ahead_log.hpp"

namespace seqloop::sqlite {
namespace {

namespace fs = std::filesystem;

// Pages of the write-ahead log after which they go into the file itself: 8 MB.
constexpr int checkpoint_pages = 1000;

void check_form(const fs::path& path, const MapForm& form) {
  if (form.place_bytes >= 1 && form.place_bytes <= most_place_bytes) return;
  throw SetupError({path.string(), "places of " + std::to_string(form.place_bytes) + " bytes",
                    "1 to " + std::to_string(most_place_bytes) + " can be saved"});
}

Fault other_form(const fs::path& path, const MapForm& there, const MapForm& wanted) {
  std::string why;
  const auto tell = [&why](const std::string& what, const auto& is, const auto& asked) {
    if (is == asked) return;
    why += (why.empty() ? "" : ", ") + what + " " + is + " and not " + asked;
  };
  tell("form", there.form, wanted.form);
  tell("described by", there.describer, wanted.describer);
  tell("descriptor size", std::to_string(there.descriptor_size),
       std::to_string(wanted.descriptor_size));
  tell("bytes of a place", std::to_string(there.place_bytes), std::to_string(wanted.place_bytes));
  return {path.string(), "its places cannot be compared with these: " + why,
          "use the settings that it was made with, or another file"};
}

/// Whether the database is a map, in a version that is known here. Throws SetupError.
void check_kind(const fs::path& path, Database& database) {
  const std::string name = path.string();
  const std::int64_t id = database.number("PRAGMA application_id");
  if (id != application_id) {
    throw SetupError({name, "an SQLite database, but no SeqLoop map", "name a map"});
  }
  const std::int64_t version = database.number("PRAGMA user_version");
  if (version > user_version) {
    throw SetupError({name,
                      "written by a newer SeqLoop, in version " + std::to_string(version) +
                          " of the file; this one knows version " + std::to_string(user_version),
                      "use the newer one"});
  }
  if (version < 1) {
    throw SetupError({name, "its version, " + std::to_string(version) + ", is none of a map",
                      "`seqloop map recover` copies what is whole into a new file"});
  }
}

/// Before anything is read. Throws SetupError.
void check_log(const fs::path& path, const Database& database) {
  const std::string log = path.string() + "-wal";
  if (is_damaged_log(log)) {
    throw SetupError({log, "is damaged: the map has lost of what was saved last",
                      "`seqloop map recover` copies what is whole into a new file"});
  }
  if (!database.is_beside_foreign_log()) return;
  throw SetupError({log,
                    "is not the log of the map beside it, but of one that had its name and was "
                    "not closed: the two would be mixed",
                    "remove it; or put the map that it belongs to back, to have what is in both"});
}

/// Makes a file what it was before somebody wrote it and was killed, as whoever writes it next
/// would. Throws DatabaseError: it may not be written, or is damaged.
void roll_back(const fs::path& path) {
  Database database(path, SQLITE_OPEN_READWRITE);
  (void)database.number("SELECT count(*) FROM sqlite_master");
}

void check_file(const fs::path& path) {
  struct stat status {};
  const std::string name = path.string();
  if (::stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT && errno != ENOTDIR) {
      throw SetupError({name, "cannot be looked at: " + std::string(std::strerror(errno)),
                        "look at its name, and at the rights of its folders"});
    }
    throw SetupError(
        {name, "there is no such map", "name a map, or make one with `seqloop run --map`"});
  }
  if (!S_ISREG(status.st_mode)) throw SetupError({name, "is no file", "name a map"});
  if (::access(path.c_str(), R_OK) != 0) {
    throw SetupError({name, "must not be read", "look at the rights of the file"});
  }
}

/// Whether a file is there, and has bytes.
bool has_bytes(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && fs::file_size(path, error) > 0 && !error;
}

/// A file that SQLite keeps beside another: it names them by the file, not by a link to it.
fs::path beside(const fs::path& path, std::string_view tail) {
  std::error_code error;
  const fs::path file = fs::weakly_canonical(path, error);
  return (error ? path : file).string() + std::string(tail);
}

}  // namespace

MapFile::State::~State() {
  if (!writes) {
    // It could not become a map: the disk is full, or the name too long for a log beside it.
    holder.remove_made(path);
    return;
  }
  // Another file has the name now, and so has the log beside it, which SQLite would remove by name.
  std::error_code error;
  if (!holder.is_at(path) && fs::exists(path, error)) return;
  try {
    database.execute("DELETE FROM holder");
    // One file without a log beside it, where nobody reads it just now.
    database.execute("PRAGMA journal_mode = DELETE");
    if (drops && holder.made() && database.number("SELECT count(*) FROM session") == 0) {
      holder.remove_made(path);
    }
  } catch (const DatabaseError&) {  // the log stays and is read with the file
  }
}

void MapFile::State::check_place() const {
  if (holder.is_at(path)) return;
  throw SaveError(
      to_string(Fault{path.string(),
                      "the map that is written is there no more: it was removed, moved "
                      "or replaced",
                      "put it back if it was moved; else end the run, and begin anew"}));
}

void MapFile::State::load_map_row() {
  Statement row(database,
                "SELECT form, describer, descriptor_size, place_bytes, next_place, next_session, "
                "links, thumbnails, checksum FROM map");
  if (!row.step()) throw SetupError(damaged("what the map says of itself"));
  form = {row.text(0), row.text(1), static_cast<std::uint64_t>(row.integer(2)),
          static_cast<std::uint64_t>(row.integer(3))};
  counts = {row.integer(4), row.integer(5), row.integer(6), row.integer(7)};
  if (map_sum(form, counts) != row.integer(8) || form.place_bytes < 1 ||
      form.place_bytes > most_place_bytes) {
    throw SetupError(damaged("what the map says of itself"));
  }
}

void MapFile::State::save_map_row() {
  Statement(database, "INSERT OR REPLACE INTO map VALUES(1, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .with(std::string_view(form.form), std::string_view(form.describer),
            static_cast<std::int64_t>(form.descriptor_size),
            static_cast<std::int64_t>(form.place_bytes), counts.next_place, counts.next_session,
            counts.links, counts.thumbnails, map_sum(form, counts))
      .run();
}

void MapFile::State::make(const MapForm& wanted) {
  form = wanted;
  Transaction transaction(database);
  database.execute("PRAGMA application_id = " + std::to_string(application_id) +
                   "; PRAGMA user_version = " + std::to_string(user_version));
  database.execute(schema_sql);
  save_map_row();
  transaction.commit();
}

bool MapFile::State::holds_nothing() const {
  const bool none_has_any = std::ranges::all_of(sessions(), [](const SessionFacts& facts) {
    return facts.frames == 0 && facts.places == 0 && !facts.statistics;
  });
  Statement block(database, "SELECT first FROM block LIMIT 1");  // of a session that is lost
  return none_has_any && !block.step();
}

void MapFile::State::take_form(const MapForm& wanted) {
  const std::vector<SessionFacts> begun = sessions();
  form = wanted;
  Transaction transaction(database);
  for (const SessionFacts& facts : begun) save_session(facts);
  save_map_row();
  transaction.commit();
}

void check_nothing_is_left_of_another(const fs::path& path) {
  if (has_bytes(path)) return;
  const fs::path log = beside(path, "-wal");
  const fs::path journal = beside(path, "-journal");
  const bool is_rewritten = may_be_needed(journal);
  const bool is_log = has_bytes(log) && (::access(log.c_str(), R_OK) != 0 || holds_batches(log));
  if (!is_rewritten && !is_log) return;
  throw SetupError({(is_rewritten ? journal : log).string(),
                    "belongs to a map that is there no more and was not closed: what was saved "
                    "last may be in this alone",
                    "put that map back, or this beside it under its new name; if neither is "
                    "wanted, remove this"});
}

void remove_what_is_left(const fs::path& path) noexcept {
  std::error_code error;
  for (const char* tail : {"-wal", "-shm", "-journal"}) fs::remove(beside(path, tail), error);
}

MapFile MapFile::open(const fs::path& path, const std::optional<MapForm>& form) {
  if (form) {
    check_form(path, *form);
  } else {
    check_file(path);
  }
  Holder holder(path);
  try {
    check_nothing_is_left_of_another(path);
  } catch (const SetupError&) {
    holder.remove_made(path);
    throw;
  }
  if (holder.made()) {
    // SQLite would share its memory with whoever writes the other still.
    remove_what_is_left(path);
  }
  try {
    auto state = std::make_unique<State>(path, std::move(holder),
                                         SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    Database& database = state->database;
    check_log(path, database);
    // In the log, FULL would do; EXTRA is for the moments in which there is none. What is deleted
    // is overwritten: it is forgotten, and `recover` does not bring it back.
    database.execute(
        "PRAGMA page_size = " + std::to_string(page_size) +
        "; PRAGMA synchronous = EXTRA; PRAGMA secure_delete = ON; PRAGMA wal_autocheckpoint = " +
        std::to_string(checkpoint_pages));
    if (database.number("PRAGMA page_count") == 0) {
      if (!form) {
        throw SetupError({path.string(), "is empty: nothing was saved in it", "name a map"});
      }
      state->make(*form);
    } else {
      check_kind(path, database);
      state->load_map_row();
    }
    const bool other = form && *form != state->form;
    if (other && !state->holds_nothing()) throw SetupError(other_form(path, state->form, *form));
    if (database.text("PRAGMA journal_mode = WAL") != "wal") {
      throw SetupError({path.string(), "this file system cannot keep a log beside the map",
                        "put the map on a local disk"});
    }
    state->writes = true;
    sign(database);
    if (other) state->take_form(*form);
    return MapFile(std::move(state));
  } catch (const DatabaseError& error) {
    throw SetupError(fault_of(path, error));
  }
}

MapFile MapFile::read_only(const fs::path& path) {
  check_file(path);
  std::error_code error;
  const auto begin = [&](const char* vfs) {
    auto state = std::make_unique<State>(path, Holder(), SQLITE_OPEN_READONLY, vfs);
    // Where nobody can write, nobody does: no locks are needed, and the log is looked up in memory.
    check_log(path, state->database);
    if (vfs != nullptr) state->database.execute("PRAGMA locking_mode = EXCLUSIVE");
    // From here on, what is read is of one moment.
    state->database.execute("BEGIN");
    if (state->database.number("PRAGMA page_count") == 0) {
      throw SetupError({path.string(), "is empty: nothing was saved in it", "name a map"});
    }
    check_kind(path, state->database);
    state->load_map_row();
    return MapFile(std::move(state));
  };
  try {
    try {
      return begin(nullptr);
    } catch (const DatabaseError& refused) {
      if (refused.is_half_written()) {
        try {
          roll_back(path);
        } catch (const DatabaseError& again) {
          if (again.primary() == SQLITE_CORRUPT) throw;
          throw refused;  // the file, its journal or their folder may not be written
        }
        return begin(nullptr);
      }
      const fs::path folder = fs::absolute(path).parent_path();
      const bool fixed = ::access(folder.c_str(), W_OK) != 0;
      if (!fixed ||
          (refused.primary() != SQLITE_CANTOPEN && refused.primary() != SQLITE_READONLY)) {
        throw;
      }
      return begin("unix-none");
    }
  } catch (const DatabaseError& refused) {
    throw SetupError(fault_of(path, refused));
  }
}

MapFile::MapFile(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;
MapFile::~MapFile() = default;

void MapFile::checkpoint() {
  if (!state_->writes) return;
  state_->check_place();
  try {
    state_->database.execute("PRAGMA wal_checkpoint(PASSIVE)");
  } catch (const DatabaseError& error) {
    throw SaveError(to_string(fault_of(state_->path, error)));
  }
}

void MapFile::drop_if_unused() noexcept { state_->drops = true; }
const fs::path& MapFile::path() const noexcept { return state_->path; }
const MapForm& MapFile::form() const noexcept { return state_->form; }
bool MapFile::holds_nothing() const {
  return state_->reading([this] { return state_->holds_nothing(); });
}
std::uint64_t MapFile::next_place() const {
  return static_cast<std::uint64_t>(state_->counts.next_place);
}

}  // namespace seqloop::sqlite
