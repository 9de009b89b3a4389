// SPDX-License-Identifier: MIT
#include "experiment/report/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "program/process/utf8.hpp"

namespace seqloop::experiment {
namespace {

/// @return bytes of the first character; 0 where there is none that XML may hold
std::size_t character(std::string_view text) {
  const program::Character first = program::first_character(text);
  const bool control =
      first.code < 0x20 && first.code != '\t' && first.code != '\n' && first.code != '\r';
  const bool none = (first.code & 0xFFFEU) == 0xFFFE;
  return control || none ? 0 : first.bytes;
}

/// Calls `use` with every character in turn; U+FFFD for what is none.
template <class Use>
void for_each_character(std::string_view text, Use use) {
  while (!text.empty()) {
    const std::size_t length = character(text);
    use(length == 0 ? std::string_view("\uFFFD") : text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
}

/// Width of a character in DejaVu Sans, in units of the font's size: the widest of the fonts that a
/// page may be shown in, and the one of a Debian that has no other.
double advance(std::string_view character) {
  if (character.size() > 1) return character.size() == 2 ? 0.84 : 1.0;
  const char c = character.front();
  if (std::string_view("ijl'|").find(c) != std::string_view::npos) return 0.34;
  if (std::string_view("ftrI ./,:;!()[]-").find(c) != std::string_view::npos) return 0.42;
  if (std::string_view("mMW%@").find(c) != std::string_view::npos) return 1.0;
  if (std::string_view("w+=<>#~^&").find(c) != std::string_view::npos) return 0.84;
  return c >= 'A' && c <= 'Z' ? 0.79 : 0.64;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for_each_character(text, [&](std::string_view character) {
    switch (character.front()) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += character;
    }
  });
  return safe;
}

double text_width(std::string_view text, double size) {
  double width = 0.0;
  for_each_character(text, [&](std::string_view character) { width += advance(character) * size; });
  return width;
}

std::string shortened(std::string_view text, double size, double width) {
  std::vector<std::string_view> kept;
  for_each_character(text, [&](std::string_view character) { kept.push_back(character); });
  double needed = text_width(text, size);
  if (needed <= width) return std::string(text);
  needed += advance("…") * size;
  std::size_t cut = kept.size() / 2;  // names differ at their ends
  while (needed > width && !kept.empty()) {
    cut = kept.size() / 2;
    needed -= advance(kept[cut]) * size;
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(cut));
  }
  std::string short_text;
  for (std::size_t i = 0; i < kept.size(); ++i)
    short_text += (i == cut ? "…" : "") + std::string(kept[i]);
  return cut < kept.size() ? short_text : short_text + "…";
}

std::vector<std::string> wrapped(std::string_view text, double size, double width) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string word(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!lines.empty() && text_width(lines.back() + ' ' + word, size) <= width) {
      lines.back() += ' ' + word;
    } else {
      lines.push_back(shortened(word, size, width));
    }
  }
  return lines;
}

std::string slug(std::string_view title) {
  constexpr std::size_t longest = 40;
  std::string name;
  for (const char c : title) {
    const char small = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool plain = (small >= 'a' && small <= 'z') || (small >= '0' && small <= '9');
    if (plain) name += small;
    if (!plain && !name.empty() && name.back() != '-') name += '-';
  }
  name.resize(std::min(name.size(), longest));
  while (name.ends_with('-')) name.pop_back();
  return name;
}

double number_in(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? value : std::numeric_limits<double>::quiet_NaN();
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return k < bytes.size() ? bytes[k] : 0U; };
    const std::uint32_t group = (byte(i) << 16U) | (byte(i + 1) << 8U) | byte(i + 2);
    for (const unsigned shift : {18U, 12U, 6U, 0U}) text += digits[(group >> shift) & 63U];
  }
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  return text.replace(text.size() - padding, padding, padding, '=');
}

}  // namespace seqloop::experiment
