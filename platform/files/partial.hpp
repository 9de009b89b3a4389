// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::files {

enum class PartialKind : std::uint8_t { file, folder };

/// What an output is until it is complete: `.NAME.partial-PID` beside the place where it will be. A
/// lock on it, which ends with the process, tells others that somebody is still at work.
struct Partial {
  std::filesystem::path path;
  int descriptor = -1;  ///< the file, for writing, or the folder; locked. The caller closes it.
};

/// Makes one, after removing those of the same output that killed processes left.
/// @return no descriptor where it cannot be made; `errno` says why
[[nodiscard]] Partial make_partial(const std::filesystem::path& output, PartialKind kind);

/// That the folder is missing in which something is to be made. @param shown what
[[nodiscard]] inline Fault missing_folder(std::string shown, const std::filesystem::path& folder) {
  return {std::move(shown), "its folder does not exist", "create " + folder.string() + " first"};
}

/// What an errno means, in words.
[[nodiscard]] inline std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace seqloop::files
