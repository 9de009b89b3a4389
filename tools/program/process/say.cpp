// SPDX-License-Identifier: MIT
#include "program/process/say.hpp"

#include <algorithm>

#include "program/process/utf8.hpp"

namespace seqloop::program {
namespace {

/// Whether a terminal would do something else with a character than show it.
bool is_obeyed(char32_t code) {
  const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool turns_direction = code == 0x200E || code == 0x200F ||
                               (code >= 0x2028 && code <= 0x202E) ||
                               (code >= 0x2066 && code <= 0x2069);
  return control || turns_direction;
}

std::string shown(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t bytes = std::max<std::size_t>(character.bytes, 1);
    if (character.bytes > 0 && !is_obeyed(character.code)) {
      line += text.substr(0, bytes);
    } else {
      for (const char byte : text.substr(0, bytes)) {
        line += fmt::format("\\x{:02X}", static_cast<unsigned char>(byte));
      }
    }
    text.remove_prefix(bytes);
  }
  return line;
}

}  // namespace

std::string printable(std::string_view line) {
  constexpr std::size_t most = 4'000;
  // What is wrong stands in front, what to do about it behind.
  constexpr std::size_t front = 3'000;
  constexpr std::size_t back = most - front;
  if (line.size() <= most) return shown(line);
  return fmt::format("{} [... {} bytes ...] {}", shown(line.substr(0, front)), line.size() - most,
                     shown(line.substr(line.size() - back)));
}

std::string printable_lines(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines += printable(text.substr(0, end));
    if (end < text.size()) lines += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace seqloop::program
