// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace seqloop::sqlite {

/// Whether a log that SQLite keeps beside a file holds batches that were saved, and are not to be
/// had any more: one of its frames is not whole, and at least two batches end behind it. SQLite
/// reads no further than to that frame, and the next writer writes over the rest. A batch that was
/// cut off by a crash is the last one, since each is on the disk before the next begins.
/// @param log need not be there
/// Source: https://www.sqlite.org/fileformat2.html, section 4.
[[nodiscard]] bool is_damaged_log(const std::filesystem::path& log);

/// Whether a log holds a batch that was saved. @param log need not be there
[[nodiscard]] bool holds_batches(const std::filesystem::path& log);

/// Puts all pages of a log that are whole into the file, up to where the last batch ends.
/// Throws SaveError: the file cannot be written.
void put_log_into(const std::filesystem::path& file, const std::filesystem::path& log);

}  // namespace seqloop::sqlite
