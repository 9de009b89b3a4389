// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::program {

/// What becomes of a file or a folder that a command was told of.
enum class Access : std::uint8_t {
  reads,   ///< a file, or a folder with all that is in it
  writes,  ///< a file
  fills    ///< a folder, with files of one's own
};

/// A name that a command was told, and what for. Empty names stand for nothing.
struct FileUse {
  std::string flag;  ///< which names it, without dashes
  Access access;
  std::filesystem::path path;
};

/// Adds a fault for every output that is an input, too, or another output: whatever the spelling,
/// through links of both kinds. In a folder that is read nothing may be replaced, it may not be
/// filled, and nothing may come there that would be a part of the drive.
void refuse_overwriting(Faults& faults, const std::vector<FileUse>& uses);

/// Adds a fault when a folder is not there and cannot be made.
void check_folder(Faults& faults, const std::filesystem::path& folder);

/// Throws SetupError when the folder is not there and cannot be made.
void make_folder(const std::filesystem::path& folder);

}  // namespace seqloop::program
