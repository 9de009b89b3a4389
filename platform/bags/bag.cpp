// SPDX-License-Identifier: MIT
#include "seqloop/bags/bag.hpp"

#include "bags/bag_folder.hpp"
#include "bags/byte_source.hpp"
#include "bags/db3_bag.hpp"
#include "bags/mcap_bag.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::bags {

bool is_bag(const std::filesystem::path& path) {
  return path.extension() == ".mcap" || path.extension() == ".db3" || holds_bag(path);
}

std::unique_ptr<Bag> open_bag(const std::filesystem::path& path) {
  std::error_code error;
  const bool there = std::filesystem::exists(path, error);
  if (error)
    throw SetupError(
        Fault{path.string(), "cannot be read: " + error.message(), "check the permissions"});
  if (!there) throw SetupError(Fault{path.string(), "does not exist", "check the name"});
  if (std::filesystem::is_directory(path, error)) {
    if (holds_bag(path)) return open_bag_folder(path);
    throw SetupError(Fault{path.string(), "holds no .mcap and no .db3 file", "name a bag"});
  }
  if (path.extension() == ".db3") return open_db3(path);
  return open_mcap(open_file(path), path.string());
}

}  // namespace seqloop::bags
