// SPDX-License-Identifier: MIT
#include "files/text_file.hpp"

#include <fstream>

#include "seqloop/fault.hpp"

namespace seqloop::files {

void refuse_empty(const std::filesystem::path& path, const std::string& remedy) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  if (std::filesystem::file_size(path, error) == 0)
    throw SetupError(Fault{path.string(), "is empty", remedy});
}

std::string read_bytes(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  const std::string shown = path.string();
  std::error_code error;
  const bool there = std::filesystem::exists(path, error);
  if (error) {
    throw SetupError(Fault{shown, "cannot be read: " + error.message(), "check its permissions"});
  }
  if (!there) {
    throw SetupError(Fault{shown, "does not exist", "check the name"});
  }
  // A device or a pipe could go on for ever.
  if (!std::filesystem::is_regular_file(path, error)) {
    throw SetupError(Fault{shown, "is not a file", "give a text file"});
  }
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes > most_bytes) {
    throw SetupError(
        Fault{shown, error ? error.message()
                           : "is larger than " + std::to_string(most_bytes >> 20U) + " MiB"});
  }
  std::string text(static_cast<std::size_t>(bytes), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(bytes));
  if (!stream) throw SetupError(Fault{shown, "cannot be read", "check its permissions"});
  return text;
}

std::string read_text(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  std::string text = read_bytes(path, most_bytes);
  if (text.find('\0') != std::string::npos) {
    throw SetupError(
        Fault{path.string(), "is no text in UTF-8: it holds zeros", "give a text file"});
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

}  // namespace seqloop::files
