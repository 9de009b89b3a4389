// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "seqloop/bags/bag.hpp"

namespace seqloop::bags {

/// What a folder's metadata.yaml says that matters here.
struct BagMetadata {
  std::vector<std::string> files;  ///< names in the folder, in order
  std::string compression;         ///< of messages or files; empty: none
};

/// Takes the lines it needs from YAML as rosbag2 writes it.
[[nodiscard]] BagMetadata parse_metadata(const std::string& yaml);

/// Whether a folder holds files of a bag.
[[nodiscard]] bool holds_bag(const std::filesystem::path& folder);

/// Opens a folder of rosbag2. Throws SetupError.
[[nodiscard]] std::unique_ptr<Bag> open_bag_folder(const std::filesystem::path& folder);

}  // namespace seqloop::bags
