// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace seqloop::opencv {

/// The order in which people number files: image2 before image10.
/// Runs of digits compare as numbers of any length, everything else byte by
/// byte; names that are equal so far compare byte by byte as a whole, so the order is total.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b) noexcept;

}  // namespace seqloop::opencv
