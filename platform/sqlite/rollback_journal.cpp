// SPDX-License-Identifier: MIT
#include "sqlite/rollback_journal.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <span>
#include <system_error>

namespace seqloop::sqlite {

bool may_be_needed(const std::filesystem::path& journal) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(journal, error)) return false;
  std::ifstream file(journal, std::ios::binary);
  if (!file) return true;
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
