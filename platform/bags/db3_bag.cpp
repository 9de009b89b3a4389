// SPDX-License-Identifier: MIT
#include "bags/db3_bag.hpp"

#include "seqloop/fault.hpp"

#if SEQLOOP_SQLITE
#include <sqlite3.h>

#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "bags/byte_source.hpp"

namespace seqloop::bags {
namespace {

struct Close {
  void operator()(sqlite3* database) const noexcept { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Close>;
using Statement = std::unique_ptr<sqlite3_stmt, Close>;

std::string text_at(sqlite3_stmt* row, int column) {
  const void* text = sqlite3_column_text(row, column);
  if (text == nullptr) return {};
  return {static_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(row, column))};
}

/// Opens for reading without leaving traces: a file that its writer has closed is not locked, and
/// nothing is made beside it.
Database connect(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw SetupError(Fault{
        file.string(), std::filesystem::exists(file, error) ? "is not a file" : "does not exist"});
  for (const char* beside : {"-wal", "-journal"}) {
    const std::filesystem::path rest = file.string() + beside;
    if (std::filesystem::file_size(rest, error) > 0 && !error)
      throw SetupError(
          Fault{file.string(), "its writer has not closed it: there is also " + rest.string(),
                "end the recording, or copy both files and open the copy with sqlite3 once"});
  }
  std::string name = "file:";
  constexpr std::string_view hex = "0123456789abcdef";
  for (const char c : std::filesystem::absolute(file, error).string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '.' || c == '_' || c == '-';
    if (plain) {
      name += c;
    } else {
      name += {'%', hex[byte >> 4U], hex[byte & 15U]};
    }
  }
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2((name + "?immutable=1").c_str(), &opened,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database(opened);
  if (code != SQLITE_OK) throw SetupError(Fault{file.string(), sqlite3_errstr(code)});
  return database;
}

Database connect(std::span<const std::uint8_t> bytes) {
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(":memory:", &opened, SQLITE_OPEN_READWRITE, nullptr);
  Database database(opened);
  if (code != SQLITE_OK) throw std::bad_alloc();
  // SQLite takes memory that could be written; this it only reads.
  auto* memory = const_cast<unsigned char*>(bytes.data());
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  if (sqlite3_deserialize(database.get(), "main", memory, size, size,
                          SQLITE_DESERIALIZE_READONLY) != SQLITE_OK)
    throw SetupError(Fault{"db3", "is not an SQLite file"});
  return database;
}

class Db3Bag : public Bag {
 public:
  /// @param bytes of the file
  Db3Bag(Database database, std::string name, std::uint64_t bytes)
      : name_(std::move(name)), database_(std::move(database)), most_steps_(most_steps(bytes)) {
    // A file from somebody else: its own views, triggers and functions are not run.
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(database_.get(), SQLITE_LIMIT_LENGTH, static_cast<int>(most_bytes));
    sqlite3_progress_handler(database_.get(), steps_at_once, &Db3Bag::stop_circles, this);
    read_facts();
  }

  [[nodiscard]] const BagFacts& facts() const noexcept override { return facts_; }

  void choose(std::string_view topic) override {
    ended_ = false;
    // In the order in which they were written, which rosbag2 keeps: nothing has to be sorted.
    rows_ = prepare(
        "SELECT m.timestamp, m.data FROM messages m WHERE m.topic_id IN "
        "(SELECT id FROM topics WHERE name = ?1) ORDER BY m.rowid");
    // The text may be gone at the first step.
    sqlite3_bind_text(rows_.get(), 1, topic.data(), static_cast<int>(topic.size()),
                      SQLITE_TRANSIENT);
  }

  [[nodiscard]] Read next(Message& message) override {
    message = {};
    if (!rows_ || ended_) return Read::end;
    const int code = sqlite3_step(rows_.get());
    if (code == SQLITE_ROW) {
      message.time_ns = sqlite3_column_int64(rows_.get(), 0);
      const void* data = sqlite3_column_blob(rows_.get(), 1);
      message.bytes = {static_cast<const std::uint8_t*>(data),
                       static_cast<std::size_t>(sqlite3_column_bytes(rows_.get(), 1))};
      if (data == nullptr && sqlite3_errcode(database_.get()) == SQLITE_NOMEM)
        throw std::bad_alloc();
      return Read::message;
    }
    ended_ = true;
    if (code == SQLITE_DONE) return Read::end;
    if (code == SQLITE_NOMEM) throw std::bad_alloc();
    note_ = "the file ends early: " + std::string(sqlite3_errstr(code));
    message.fault = note_;
    return Read::damaged;
  }

  [[nodiscard]] std::vector<std::string> notes() const override {
    if (note_.empty()) return {};
    return {note_};
  }

 private:
  static constexpr int steps_at_once = 1000;

  /// Of SQLite's machine, for one statement. Of bags whose messages are empty it needs 1.1 a byte.
  static std::uint64_t most_steps(std::uint64_t bytes) { return 10 * (bytes + 100'000); }

  /// Pages that name the same pages again and again make rows without end of a few bytes.
  static int stop_circles(void* self) {
    auto& bag = *static_cast<Db3Bag*>(self);
    bag.steps_ += steps_at_once;
    return bag.steps_ > bag.most_steps_ ? 1 : 0;
  }

  Statement prepare(const std::string& text) {
    steps_ = 0;
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(database_.get(), text.c_str(), -1, &made, nullptr);
    Statement statement(made);
    if (code != SQLITE_OK) refuse(code);
    return statement;
  }

  [[noreturn]] void refuse(int code) const {
    if (code == SQLITE_NOMEM) throw std::bad_alloc();
    if (code == SQLITE_INTERRUPT)
      throw SetupError(Fault{name_, "is damaged: it has more rows than there is room for in it",
                             "copy it anew, or take what `sqlite3 FILE .recover` finds"});
    throw SetupError(Fault{name_, "is not a bag of rosbag2 (" + std::string(sqlite3_errstr(code)) +
                                      ": " + sqlite3_errmsg(database_.get()) + ")"});
  }

  /// @param row called for each
  template <class Row>
  void each_row(const std::string& text, Row row) {
    const Statement statement = prepare(text);
    int code = sqlite3_step(statement.get());
    for (; code == SQLITE_ROW; code = sqlite3_step(statement.get())) row(statement.get());
    if (code != SQLITE_DONE) refuse(code);
  }

  void read_facts() {
    facts_.format = "rosbag2 db3";
    int tables = 0;
    bool says_version = false;
    // A view of that name could do anything.
    each_row("SELECT name FROM sqlite_schema WHERE type = 'table'", [&](sqlite3_stmt* row) {
      const std::string table = text_at(row, 0);
      if (table == "topics" || table == "messages") ++tables;
      if (table == "schema") says_version = true;
    });
    if (tables != 2)
      throw SetupError(
          Fault{name_, "is not a bag of rosbag2: it has no tables of topics and messages"});
    if (says_version)
      each_row("SELECT schema_version FROM schema LIMIT 1",
               [&](sqlite3_stmt* row) { facts_.format += ", schema " + text_at(row, 0); });
    bool says_encoding = false;
    each_row("SELECT name FROM pragma_table_info('topics')", [&](sqlite3_stmt* row) {
      says_encoding = says_encoding || text_at(row, 0) == "serialization_format";
    });
    each_row(std::string("SELECT t.name, t.type, ") +
                 (says_encoding ? "t.serialization_format" : "'cdr'") +
                 ", coalesce(c.messages, 0) FROM topics t LEFT JOIN"
                 " (SELECT topic_id, count(*) AS messages FROM messages GROUP BY topic_id) c"
                 " ON c.topic_id = t.id ORDER BY t.name, t.id",
             [&](sqlite3_stmt* row) {
               const auto messages = static_cast<std::uint64_t>(sqlite3_column_int64(row, 3));
               Topic topic{text_at(row, 0), text_at(row, 1), text_at(row, 2), messages};
               if (!facts_.topics.empty() && facts_.topics.back().name == topic.name) {
                 facts_.topics.back().messages += messages;
               } else {
                 facts_.topics.push_back(std::move(topic));
               }
             });
    each_row("SELECT min(timestamp), max(timestamp) FROM messages", [&](sqlite3_stmt* row) {
      facts_.start_ns = sqlite3_column_int64(row, 0);
      facts_.end_ns = sqlite3_column_int64(row, 1);
    });
  }

  std::string name_;
  Database database_;
  std::uint64_t most_steps_;
  std::uint64_t steps_ = 0;  ///< of the newest statement
  BagFacts facts_;
  Statement rows_;
  bool ended_ = false;
  std::string note_;
};

}  // namespace

std::unique_ptr<Bag> open_db3(const std::filesystem::path& file) {
  Database database = connect(file);
  return std::make_unique<Db3Bag>(std::move(database), file.string(),
                                  std::filesystem::file_size(file));
}

std::unique_ptr<Bag> open_db3(std::span<const std::uint8_t> bytes) {
  return std::make_unique<Db3Bag>(connect(bytes), "db3", bytes.size());
}

}  // namespace seqloop::bags
#else
namespace seqloop::bags {
namespace {

[[noreturn]] void refuse(const std::string& name) {
  throw SetupError(Fault{name, "this build has no libsqlite3, which reads it",
                         "install libsqlite3-dev and build again, or convert the bag to .mcap"});
}

}  // namespace

std::unique_ptr<Bag> open_db3(const std::filesystem::path& file) { refuse(file.string()); }

std::unique_ptr<Bag> open_db3(std::span<const std::uint8_t> /*bytes*/) { refuse("db3"); }

}  // namespace seqloop::bags
#endif
