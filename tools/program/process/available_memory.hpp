// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace seqloop::program {

/// Bytes that this program can take without pushing anything out; everything where nobody knows.
[[nodiscard]] std::uint64_t available_memory();

/// Bytes of memory that this process has resident; 0 where nobody knows.
[[nodiscard]] std::uint64_t resident_memory();

/// Whether so much can be had with a tenth to spare. Says so on stderr where not.
[[nodiscard]] bool fits_memory(std::uint64_t bytes, std::string_view what);

}  // namespace seqloop::program
