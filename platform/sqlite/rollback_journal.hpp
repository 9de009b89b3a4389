// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace seqloop::sqlite {

/// Whether a journal that SQLite keeps beside a file while it rewrites it may be needed to make
/// that file what it was: it is of a file that had anything, and what it holds is on the disk. It
/// is not where a file was being made, nor before the first write into one. Reads 20 bytes.
/// @param journal need not be there; one that must not be read may be needed
/// Source: https://www.sqlite.org/fileformat2.html, section 3.
[[nodiscard]] bool may_be_needed(const std::filesystem::path& journal);

}  // namespace seqloop::sqlite
