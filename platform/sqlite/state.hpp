// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "seqloop/sqlite/map_file.hpp"
#include "sqlite/database.hpp"
#include "sqlite/holder.hpp"
#include "sqlite/rows_ahead.hpp"
#include "sqlite/schema.hpp"

namespace seqloop::sqlite {

using TakeBlock = std::function<void(const PlaceBlock&)>;
using Tell = std::function<void(const std::string&)>;

/// @return the name, with a number behind it where it is taken
[[nodiscard]] std::string free_name(const std::vector<SessionFacts>& taken,
                                    const std::string& name);

/// What an open map is made of. The lock goes last.
struct MapFile::State {
  State(std::filesystem::path file, Holder lock, int flags, const char* vfs = nullptr)
      : path(std::move(file)), holder(std::move(lock)), database(path, flags, vfs) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  State(State&&) = delete;
  State& operator=(State&&) = delete;
  ~State();

  std::filesystem::path path;
  Holder holder;
  Database database;
  bool writes = false;
  bool drops = false;
  MapForm form;
  Counts counts;

  [[nodiscard]] Fault damaged(const std::string& what) const {
    return {path.string(), what + " is damaged",
            "`seqloop map recover` copies what is whole into a new file"};
  }

  /// Runs what sets up or reads. Throws SetupError.
  template <class Part>
  auto reading(Part part) const {
    try {
      return part();
    } catch (const DatabaseError& error) {
      throw SetupError(fault_of(path, error));
    }
  }

  /// Runs what changes the map, all of it or nothing, and keeps what is known of it in step.
  /// Throws SaveError; SetupError where the file is damaged.
  template <class Part>
  void saving(Part part) {
    if (!writes) throw SaveError(path.string() + ": it was opened to read only");
    check_place();
    if (sqlite3_get_autocommit(database.handle()) == 0) return part();  // within one of these
    const Counts before = counts;
    try {
      Transaction transaction(database);
      part();
      save_map_row();
      transaction.commit();
    } catch (const DatabaseError& error) {
      counts = before;
      throw SaveError(to_string(fault_of(path, error)));
    } catch (...) {
      counts = before;
      throw;
    }
  }

  /// Throws SaveError: nobody would find what is written now.
  void check_place() const;
  void make(const MapForm& wanted);
  [[nodiscard]] bool holds_nothing() const;
  /// Of a map that holds nothing. Throws DatabaseError.
  void take_form(const MapForm& wanted);
  void save_map_row();
  void load_map_row();
  void save_session(const SessionFacts& facts);
  [[nodiscard]] SessionFacts session(std::int64_t id) const;
  [[nodiscard]] std::vector<SessionFacts> sessions() const;
  /// "session 'monday'", as far as that can be told.
  [[nodiscard]] std::string session_name(std::int64_t id) const;
  /// Throws std::invalid_argument: a session may not give its new places these numbers, or they
  /// cannot follow its others.
  void check_numbers(std::int64_t session, const PlaceRecord& first_place,
                     std::uint64_t last) const;
  void insert_block(std::int64_t session, std::span<const PlaceRecord> records,
                    std::span<const std::byte> places);
  /// @param links `session` is not looked at
  void insert_links(std::int64_t session, std::span<const SavedLink> links);
  /// Removes one place, where there is such a one, in the open transaction.
  void remove_place(std::int64_t number);
  /// Blocks whose first number is in a range; what was removed of them is left out.
  void read(std::int64_t from, std::int64_t to, const TakeBlock& take) const;
  /// The same of rows that somebody else reads. @param told of what is damaged; none: SetupError
  void read(std::int64_t from, std::int64_t to, const GiveRows& rows, const TakeBlock& take,
            const Tell& told) const;
  /// Their rows, as they are in the file. Throws DatabaseError.
  void each_row(std::int64_t from, std::int64_t to, const TakeRow& take) const;
  /// Numbers of places that were removed of them, sorted. Throws DatabaseError.
  [[nodiscard]] std::vector<std::int64_t> removed_of(std::int64_t from, std::int64_t to,
                                                     const Tell& tell) const;
};

/// Reads what the statement stands at: first, session, count, checksum, records, places.
[[nodiscard]] BlockRow block_row(const Statement& statement);

constexpr const char* block_columns = "SELECT first, session, count, checksum, records, places ";

}  // namespace seqloop::sqlite
