// SPDX-License-Identifier: MIT
#include "sqlite/database.hpp"

#include <array>
#include <limits>

namespace seqloop::sqlite {
namespace {

// A reader that closes, or a checkpoint, holds a lock for moments.
constexpr int wait_ms = 2000;

// Of SQLite's machine, after which it is asked whether it goes on.
constexpr int steps_at_once = 1000;

/// Steps that one statement may take. Of a map of nothing but links, SQLite 3.40's own check takes
/// one a byte, and nothing takes more. What is not in the file yet is in SQLite's cache, of 2 MB.
std::uint64_t most_steps(sqlite3* handle) {
  std::uint64_t bytes = std::uint64_t{2} << 20U;
  const char* file = sqlite3_db_filename(handle, "main");
  for (const char* part : {file, sqlite3_filename_wal(file)}) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(part, error);
    if (!error) bytes += size;
  }
  constexpr std::uint64_t a_byte = 10;
  return a_byte * bytes;
}

/// The versions in the header, to write and to read: 2 while there may be a log, otherwise 1. Read
/// by SQLite's own file: closing another one would end the process's locks.
bool was_closed(sqlite3* handle) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(handle, "main", SQLITE_FCNTL_FILE_POINTER, static_cast<void*>(&file));
  constexpr sqlite3_int64 versions_at = 18;
  std::array<unsigned char, 2> versions{};
  return file != nullptr && file->pMethods != nullptr &&
         file->pMethods->xRead(file, versions.data(), versions.size(), versions_at) == SQLITE_OK &&
         versions == std::array<unsigned char, 2>{1, 1};
}

}  // namespace

Fault fault_of(const std::filesystem::path& path, const DatabaseError& error) {
  const std::string name = path.string();
  if (error.is_half_written()) {
    return {name,
            "whoever wrote it last was killed while doing so, and " + name +
                "-journal has what it was before, but may not be written",
            "look at the rights of the two and of their folder; `seqloop map recover` copies what "
            "they hold into a new file"};
  }
  switch (error.primary()) {
    case SQLITE_NOTADB:
      return {name,
              "no SeqLoop map: it is not even an SQLite database, or its first page is damaged",
              "name a map; if it was one, `seqloop map recover` finds what is left of it"};
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // the schema lacks what it must have
      return {name, std::string("the map is damaged (") + error.what() + ")",
              "`seqloop map recover` copies what is whole into a new file"};
    case SQLITE_FULL:
      return {name, "the disk is full", "make room; nothing that was saved is lost"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {name, "another program holds the database", "end it, or wait for it"};
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {name, std::string("cannot be opened or written (") + error.what() + ")",
              "look at the rights of the file and of its folder"};
    case SQLITE_NOMEM:
    case SQLITE_TOOBIG:
      return {name, std::string("does not fit in memory (") + error.what() + ")"};
    default:
      return {name, std::string("cannot be read or written (") + error.what() + ")",
              "look at the disk; what was saved before is safe if the disk is"};
  }
}

Database::Database(const std::filesystem::path& path, int flags, const char* vfs) {
  // An absolute name is no URI, whatever it begins with.
  const std::string name = std::filesystem::absolute(path).string();
  const int code = sqlite3_open_v2(name.c_str(), &handle_, flags, vfs);
  try {
    if (handle_ == nullptr) throw DatabaseError(SQLITE_NOMEM, "out of memory");
    check(code);
    sqlite3_extended_result_codes(handle_, 1);
    sqlite3_busy_timeout(handle_, wait_ms);
    // A foreign file's triggers and views must not do more than what is asked here.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_progress_handler(handle_, steps_at_once, &Database::stop_circles, this);
    execute("PRAGMA cell_size_check = ON");
  } catch (...) {
    sqlite3_close_v2(handle_);
    throw;
  }
}

Database::~Database() { sqlite3_close_v2(handle_); }

void Database::check(int code) const {
  if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) return;
  const int extended = sqlite3_extended_errcode(handle_);
  // Nobody else interrupts it.
  if (extended == SQLITE_INTERRUPT) {
    throw DatabaseError(SQLITE_CORRUPT, "it has more rows than there is room for in it");
  }
  throw DatabaseError(extended, sqlite3_errmsg(handle_));
}

int Database::stop_circles(void* self) {
  auto& database = *static_cast<Database*>(self);
  database.steps_ += steps_at_once;
  if (database.steps_ <= database.most_steps_) return 0;
  database.most_steps_ = most_steps(database.handle_);  // it may have grown
  return database.steps_ <= database.most_steps_ ? 0 : 1;
}

bool Database::is_beside_foreign_log() const {
  std::error_code error;
  const char* const log = sqlite3_filename_wal(sqlite3_db_filename(handle_, "main"));
  // Asked twice: somebody may open or close it meanwhile.
  return was_closed(handle_) && std::filesystem::file_size(log, error) > 0 && !error &&
         was_closed(handle_);
}

void Database::execute(const std::string& sql) {
  begin_steps();
  check(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr));
}

Statement Database::prepare(std::string_view sql) { return {*this, sql}; }

std::int64_t Database::number(std::string_view sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string Database::text(std::string_view sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.text(0) : std::string();
}

Statement::Statement(const Database& database, std::string_view sql) : database_(&database) {
  database.begin_steps();
  database.check(sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                    &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

bool Statement::step() {
  database_->begin_steps();
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  try {
    database_->check(code);
  } catch (...) {
    sqlite3_reset(statement_);
    throw;
  }
  return false;
}

bool Statement::next() {
  if (!step()) return false;
  const std::int64_t number = integer(0);
  if (newest_ && number <= *newest_) {
    sqlite3_reset(statement_);
    throw DatabaseError(SQLITE_CORRUPT, "the same rows come again");
  }
  newest_ = number;
  return true;
}

std::span<const std::byte> Statement::blob(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  if (data == nullptr) {
    if (sqlite3_errcode(database_->handle()) == SQLITE_NOMEM) {
      throw DatabaseError(SQLITE_NOMEM, "out of memory");
    }
    return {};
  }
  return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
}

std::string Statement::text(int column) const {
  const std::span<const std::byte> bytes = blob(column);
  std::string text(bytes.size(), '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) text[i] = std::to_integer<char>(bytes[i]);
  return text;
}

void Statement::bind(int index, std::int64_t value) {
  database_->check(sqlite3_bind_int64(statement_, index, value));
}

void Statement::bind(int index, double value) {
  database_->check(sqlite3_bind_double(statement_, index, value));
}

void Statement::bind(int index, std::string_view value) {
  database_->check(sqlite3_bind_text64(statement_, index,
                                       value.data() == nullptr ? "" : value.data(), value.size(),
                                       SQLITE_STATIC, SQLITE_UTF8));
}

void Statement::bind(int index, std::span<const std::byte> value) {
  database_->check(value.empty() ? sqlite3_bind_zeroblob(statement_, index, 0)
                                 : sqlite3_bind_blob64(statement_, index, value.data(),
                                                       value.size(), SQLITE_STATIC));
}

void Statement::bind(int index, const std::optional<std::int64_t>& value) {
  if (value) {
    bind(index, *value);
  } else {
    database_->check(sqlite3_bind_null(statement_, index));
  }
}

Transaction::~Transaction() {
  // After some errors SQLite has rolled back already.
  if (sqlite3_get_autocommit(database_.handle()) == 0) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() { database_.execute("COMMIT"); }

}  // namespace seqloop::sqlite
