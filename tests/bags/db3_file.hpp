// SPDX-License-Identifier: MIT
// Files of rosbag2, in the words of its own storage plugin.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace seqloop::test {

struct Db3Message {
  int topic;  ///< from 1
  std::int64_t time_ns;
  std::vector<std::uint8_t> data;
};

inline void run_sql(sqlite3* database, const std::string& sql) {
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    throw std::runtime_error(sqlite3_errmsg(database));
}

inline void run_sql(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  run_sql(database, sql);
  sqlite3_close(database);
}

/// @param version 1 to 4: what the tables have grown by over the years
/// @param topics  names and types
inline void write_db3(const std::filesystem::path& file, int version,
                      const std::vector<std::pair<std::string, std::string>>& topics,
                      const std::vector<Db3Message>& messages) {
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  std::string more;
  if (version >= 1) more += ",serialization_format TEXT NOT NULL";
  if (version >= 2) more += ",offered_qos_profiles TEXT NOT NULL";
  if (version >= 4) more += ",type_description_hash TEXT NOT NULL";
  run_sql(
      database,
      "BEGIN; CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL" +
          more +
          "); CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
          "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
          "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  if (version >= 3)
    run_sql(database,
            "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
            "INSERT INTO schema VALUES(" +
                std::to_string(version) +
                ", 'rolling');"
                "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL,"
                "metadata TEXT NOT NULL);");
  for (std::size_t i = 0; i < topics.size(); ++i) {
    std::string values =
        std::to_string(i + 1) + ",'" + topics[i].first + "','" + topics[i].second + "','cdr'";
    if (version >= 2) values += ",''";
    if (version >= 4) values += ",'RIHS01_0'";
    run_sql(database, "INSERT INTO topics VALUES(" + values + ")");
  }
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1,
                     &insert, nullptr);
  for (const Db3Message& message : messages) {
    sqlite3_bind_int(insert, 1, message.topic);
    sqlite3_bind_int64(insert, 2, message.time_ns);
    sqlite3_bind_blob(insert, 3, message.data.data(), static_cast<int>(message.data.size()),
                      SQLITE_STATIC);
    sqlite3_step(insert);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  run_sql(database, "COMMIT");
  sqlite3_close(database);
}

}  // namespace seqloop::test
