// SPDX-License-Identifier: MIT
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "seqloop/fault.hpp"

namespace seqloop::sqlite {

/// What SQLite refused.
class DatabaseError : public std::runtime_error {
 public:
  DatabaseError(int code, const std::string& message) : runtime_error(message), code_(code) {}
  [[nodiscard]] int code() const noexcept { return code_; }  ///< extended
  [[nodiscard]] int primary() const noexcept { return code_ & 0xFF; }
  /// Whether a journal beside the file has to make it what it was before it can be read.
  [[nodiscard]] bool is_half_written() const noexcept { return code_ == SQLITE_READONLY_ROLLBACK; }

 private:
  int code_;
};

/// What it means for a map, and what to do.
[[nodiscard]] Fault fault_of(const std::filesystem::path& path, const DatabaseError& error);

class Statement;

/// A connection. Closed by its destructor.
class Database {
 public:
  /// @param flags of sqlite3_open_v2; @param vfs how files are reached, nothing: SQLite's default
  /// Throws DatabaseError.
  Database(const std::filesystem::path& path, int flags, const char* vfs = nullptr);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  Database(Database&&) = delete;
  Database& operator=(Database&&) = delete;
  ~Database();

  /// Throws DatabaseError.
  void execute(const std::string& sql);
  [[nodiscard]] Statement prepare(std::string_view sql);
  /// The first column of the first row.
  [[nodiscard]] std::int64_t number(std::string_view sql);
  [[nodiscard]] std::string text(std::string_view sql);

  /// Whether the file says that it was closed, so that it has no log, and yet one lies beside it:
  /// that is another file's, which had this name. SQLite would put its pages into this one.
  [[nodiscard]] bool is_beside_foreign_log() const;

  [[nodiscard]] sqlite3* handle() const noexcept { return handle_; }
  /// Throws the newest error of the connection, if the code is one.
  void check(int code) const;

  /// What follows may take as many steps of SQLite's machine as a file of this size can need: where
  /// pages lead in circles, one statement takes steps without end, and SQLite does not see it.
  void begin_steps() const noexcept { steps_ = 0; }

 private:
  static int stop_circles(void* self);

  sqlite3* handle_ = nullptr;
  mutable std::uint64_t steps_ = 0;  ///< since `begin_steps`
  std::uint64_t most_steps_ = 0;     ///< of a file as large as it was when last looked at
};

/// One SQL statement; parameters and columns are counted from 0.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  Statement(Statement&&) = delete;
  Statement& operator=(Statement&&) = delete;
  ~Statement();

  /// Sets all parameters and starts from the beginning. Blobs and texts must live until the next
  /// call. @return itself
  template <class... Values>
  Statement& with(const Values&... values) {
    sqlite3_reset(statement_);
    newest_.reset();
    int index = 0;
    (bind(++index, values), ...);
    return *this;
  }

  /// @return whether there is a row. Throws DatabaseError.
  bool step();
  /// The same of rows in the order of their numbers, which are the first column. Where pages lead
  /// in circles, rows come again without end: SQLite does not see it.
  bool next();
  /// For what returns no rows.
  void run() {
    while (step()) {
    }
    sqlite3_reset(statement_);
  }

  [[nodiscard]] std::int64_t integer(int column) const {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] double real(int column) const { return sqlite3_column_double(statement_, column); }
  [[nodiscard]] bool null(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL;
  }
  /// Valid until the next step.
  [[nodiscard]] std::span<const std::byte> blob(int column) const;
  [[nodiscard]] std::string text(int column) const;

 private:
  void bind(int index, std::int64_t value);
  void bind(int index, double value);
  void bind(int index, std::string_view value);
  void bind(int index, std::span<const std::byte> value);
  void bind(int index, const std::optional<std::int64_t>& value);

  const Database* database_;
  sqlite3_stmt* statement_ = nullptr;
  std::optional<std::int64_t> newest_;  ///< number that `next` came to
};

/// BEGIN IMMEDIATE … COMMIT; rolled back by its destructor without one.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) {
    database_.execute("BEGIN IMMEDIATE");
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction(Transaction&&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  void commit();

 private:
  Database& database_;
};

}  // namespace seqloop::sqlite
