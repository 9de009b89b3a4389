// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include "seqloop/fault.hpp"

namespace seqloop::program {

/// A character that was read.
struct Character {
  std::size_t bytes = 0;  ///< 0: the text does not begin with UTF-8
  char32_t code = 0;
};

/// The first character of a text. Over-long forms and surrogates are none.
[[nodiscard]] Character first_character(std::string_view text) noexcept;

/// Whether all of a text is UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// Adds a fault where a name cannot stand in JSON. @param what has it
void check_name(Faults& faults, const char* what, std::string_view name);

}  // namespace seqloop::program
