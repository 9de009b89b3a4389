// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace seqloop::program {

/// A line that a terminal shows and does not obey: names of files, cells of tables and what a
/// camera calls itself come from outside. Control characters, what turns the direction of writing,
/// and bytes that are no UTF-8 become `\x1B` and the like. Of more than 4,000 bytes, which nobody
/// reads, the start and the end are left, with the number of bytes between them.
[[nodiscard]] std::string printable(std::string_view line);

/// The same of several lines, each by itself.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// Puts text on stderr. Work goes on when nobody can read it any more.
inline void say_raw(std::string_view text) noexcept {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

/// `seqloop: ...` and a new line on stderr, printable.
template <class... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  say_raw("seqloop: " + printable(fmt::format(format, std::forward<Values>(values)...)) + '\n');
}

}  // namespace seqloop::program
