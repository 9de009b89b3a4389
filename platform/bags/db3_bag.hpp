// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "seqloop/bags/bag.hpp"

namespace seqloop::bags {

/// Opens an SQLite file as rosbag2 writes it. Throws SetupError: not there, no such file, not
/// closed by its writer, a build without libsqlite3.
[[nodiscard]] std::unique_ptr<Bag> open_db3(const std::filesystem::path& file);

/// The same of a file in memory. @param bytes live longer
[[nodiscard]] std::unique_ptr<Bag> open_db3(std::span<const std::uint8_t> bytes);

}  // namespace seqloop::bags
