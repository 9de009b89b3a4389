#pragma once

#include <cstddef>
#include <string_view>

namespace seqloop::program {

/// Memory that can be taken without pushing anything out; everything where nobody knows.
[[nodiscard]] std::size_t available_memory();

/// Whether so much can be had with a tenth to spare. Says so on stderr where not.
[[nodiscard]] bool fits_memory(std::size_t bytes, std::string_view what);

}  // namespace seqloop::program
