// SPDX-License-Identifier: MIT
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "temporary_folder.hpp"

namespace seqloop::test {

/// Writes a number into bytes, the highest byte first.
inline void put(std::string& bytes, std::size_t place, std::size_t number, std::size_t size) {
  for (std::size_t i = size; i-- > 0; number >>= 8U)
    bytes.at(place + i) = static_cast<char>(number & 0xffU);
}

/// An inner page of an SQLite table that leads to the same page 500 times.
inline std::string inner_page(std::size_t page_size, std::size_t child) {
  constexpr std::size_t cells = 500;
  constexpr std::size_t cell_bytes = 5;  // the page below, and its last row
  std::string page(page_size, '\0');
  page[0] = 5;
  put(page, 3, cells, 2);
  put(page, 5, page_size - cell_bytes * cells, 2);
  put(page, 8, child, 4);
  for (std::size_t i = 1; i <= cells; ++i) {
    const std::size_t cell = page_size - cell_bytes * i;
    put(page, 10 + 2 * i, cell, 2);
    put(page, cell, child, 4);
    page[cell + 4] = 5;
  }
  return page;
}

/// Damages an SQLite file so that a table seems to have each of its rows 500 times, and that so
/// often as it has levels of inner pages then: with five, no computer reads it to its end.
inline void lead_in_circles(const std::filesystem::path& file, const std::string& table,
                            std::size_t levels = 2) {
  sqlite3* database = nullptr;
  sqlite3_stmt* row = nullptr;
  sqlite3_open(file.c_str(), &database);
  const std::string sql = "SELECT rootpage FROM sqlite_schema WHERE name = '" + table + "'";
  sqlite3_prepare_v2(database, sql.c_str(), -1, &row, nullptr);
  sqlite3_step(row);
  const auto root = static_cast<std::size_t>(sqlite3_column_int64(row, 0));
  sqlite3_finalize(row);
  sqlite3_close(database);

  std::string bytes = read_all(file);
  const std::size_t size = static_cast<std::size_t>(static_cast<unsigned char>(bytes[16])) << 8U |
                           static_cast<std::size_t>(static_cast<unsigned char>(bytes[17]));
  const std::size_t pages = bytes.size() / size;
  const std::string rows = bytes.substr((root - 1) * size, size);
  bytes.replace((root - 1) * size, size, inner_page(size, pages + 1));
  for (std::size_t level = 1; level < levels; ++level) {
    bytes += inner_page(size, pages + level + 1);
  }
  bytes += rows;
  put(bytes, 28, pages + levels, 4);
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace seqloop::test
