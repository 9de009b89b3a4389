// SPDX-License-Identifier: MIT
#include "experiment/run/fingerprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "seqloop/fault.hpp"

namespace seqloop::experiment {
namespace {

std::string state_of_file(const std::filesystem::directory_entry& entry) {
  return fmt::format("{}|{}|{};", entry.path().filename().string(), entry.file_size(),
                     entry.last_write_time().time_since_epoch().count());
}

}  // namespace

std::string fingerprint(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char letter : text) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  }
  return fmt::format("{:016x}", hash);
}

std::string state_of(const std::filesystem::path& path) {
  try {
    if (!std::filesystem::is_directory(path)) {
      return state_of_file(std::filesystem::directory_entry(path));
    }
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(state_of_file(entry));
    }
    std::ranges::sort(files);
    return fmt::format("{}", fmt::join(files, ""));
  } catch (const std::filesystem::filesystem_error& error) {
    throw SetupError(Fault{path.string(), error.code().message()});
  }
}

std::string text_of(const std::vector<Setting>& settings) {
  std::string text;
  for (const Setting& setting : settings) text += setting.name + '=' + setting.value + ';';
  return text;
}

std::string file_name(std::string_view name) {
  constexpr std::size_t longest = 60;
  std::string found;
  for (const char letter : name.substr(0, longest)) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    if (plain) {
      found += letter;
    } else if (!found.empty() && found.back() != '-') {
      found += '-';
    }
  }
  return found;
}

}  // namespace seqloop::experiment
