// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

namespace seqloop::program {

/// Puts text on stderr. Work goes on when nobody can read it any more.
inline void say_raw(std::string_view text) noexcept {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

/// `seqloop: ...` and a new line on stderr.
template <class... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  say_raw("seqloop: " + fmt::format(format, std::forward<Values>(values)...) + '\n');
}

}  // namespace seqloop::program
