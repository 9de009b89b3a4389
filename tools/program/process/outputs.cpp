// SPDX-License-Identifier: MIT
#include "program/process/outputs.hpp"

#include <unistd.h>

#include <algorithm>

namespace seqloop::program {

void refuse_overwriting(Faults& faults, const std::filesystem::path& out,
                        const std::vector<std::filesystem::path>& inputs) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(out, error)) return;
  const std::filesystem::path folder = std::filesystem::absolute(out, error).parent_path();
  const auto holds_out = [&](const std::filesystem::path& input) {
    return !input.empty() && (std::filesystem::equivalent(input, out, error) ||
                              std::filesystem::equivalent(input, folder, error));
  };
  if (std::ranges::any_of(inputs, holds_out)) {
    faults.push_back(
        {"out", "writing " + out.string() + " would destroy an input", "choose another name"});
  }
}

void check_folder(Faults& faults, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(there, error) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!std::filesystem::is_directory(there, error)) {
    faults.push_back({folder.string(), there.string() + " is not a folder"});
  } else if (::access(there.c_str(), W_OK) != 0) {
    faults.push_back({folder.string(), there.string() + " may not be written"});
  }
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SetupError(Fault{folder.string(), "cannot be made: " + error.message()});
}

}  // namespace seqloop::program
