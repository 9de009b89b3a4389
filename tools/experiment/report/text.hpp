// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::experiment {

/// Text for XML and HTML, between tags and in attributes. What XML cannot hold (control characters,
/// bytes that are no UTF-8) becomes U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// @param size of the font, pixels
/// @return about the pixels that the text takes in Arial, which its look-alikes share
[[nodiscard]] double text_width(std::string_view text, double size);

/// The text, or as much of its start and end as fits into `width` pixels, around an ellipsis.
[[nodiscard]] std::string shortened(std::string_view text, double size, double width);

/// The text broken at spaces into lines of at most `width` pixels, longer words apart.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, double size, double width);

/// Small letters, digits and single dashes, at most 40 of them: a part of a file's name.
[[nodiscard]] std::string slug(std::string_view title);

/// @return NaN for a text that is no number from its first to its last character
[[nodiscard]] double number_in(std::string_view text);

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace seqloop::experiment
