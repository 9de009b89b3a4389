// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace seqloop::program {

/// Whether a file begins as SQLite's do: a map, or another database. False where it cannot be read.
[[nodiscard]] inline bool is_database(const std::filesystem::path& path) {
  constexpr std::string_view begins = "SQLite format 3";
  std::array<char, begins.size()> head{};
  // A file of the kernel's has no bytes, and may keep its reader waiting.
  std::error_code error;
  if (std::filesystem::file_size(path, error) < head.size() || error) return false;
  std::ifstream file(path, std::ios::binary);
  return file.read(head.data(), head.size()) && std::ranges::equal(head, begins);
}

}  // namespace seqloop::program
