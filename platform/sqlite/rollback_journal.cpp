// SPDX-License-Identifier: MIT
#include "sqlite/rollback_journal.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <span>

namespace seqloop::sqlite {

bool may_be_needed(const std::filesystem::path& journal) {
  if (::access(journal.c_str(), R_OK) != 0) return errno != ENOENT && errno != ENOTDIR;
  std::ifstream file(journal, std::ios::binary);
  std::array<char, 20> head{};
  if (!file.read(head.data(), head.size())) return false;
  // The magic is written last, when all else is on the disk.
  constexpr std::array<unsigned char, 8> magic{0xD9, 0xD5, 0x05, 0xF9, 0x20, 0xA1, 0x63, 0xD7};
  const auto byte = [](char c) { return static_cast<unsigned char>(c); };
  const std::span<const char> pages_before = std::span<const char>(head).subspan(16);
  return std::ranges::equal(std::span<const char>(head).first(magic.size()), magic, {}, byte) &&
         std::ranges::any_of(pages_before, [](char c) { return c != 0; });
}

}  // namespace seqloop::sqlite
