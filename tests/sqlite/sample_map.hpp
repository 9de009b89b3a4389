// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::test {

/// The form of the maps below: places of 200 bytes.
[[nodiscard]] sqlite::MapForm sample_form();

/// The bytes of place `number`; the same each time.
[[nodiscard]] std::vector<std::byte> sample_place(std::uint64_t number, std::size_t bytes = 200);

/// Saves places, with links, a thumbnail and statistics that follow from the numbers.
/// @param frames the session has so far @param removed places that go at the same time
/// @param first number; nothing: the next @param jpeg the thumbnail begins as a JPEG file does
void save_sample(sqlite::MapFile& map, std::int64_t session, std::uint64_t frames,
                 std::size_t places, std::vector<std::uint64_t> removed = {},
                 std::optional<std::uint64_t> first = std::nullopt, bool jpeg = false);

/// Gives a place of a map another frame, with the right checksum: `save` would refuse it.
void set_frame(const std::filesystem::path& path, std::uint64_t number, std::uint64_t frame);

/// The head of the journal of a file that had so many pages before it was rewritten.
[[nodiscard]] std::string journal_of(std::uint8_t pages);

/// All that a map holds, as text; two maps that say the same are the same. `check` must find
/// nothing wrong. @param fault told what is wrong, else
[[nodiscard]] std::string content_of(const sqlite::MapFile& map, std::string& fault);

}  // namespace seqloop::test
