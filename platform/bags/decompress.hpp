// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace seqloop::bags {

/// What came out of a chunk.
struct Decompressed {
  std::span<const std::uint8_t> bytes;  ///< as many as could be had, also where there is a fault
  std::string_view fault;               ///< empty where all of it could
};

/// Unpacks a chunk, block by block: of one that is cut off, what is whole comes out.
/// @param compression as MCAP names it: nothing, `lz4`, `zstd`
/// @param size  bytes that the chunk says it has unpacked
/// @param buffer grows as bytes come out, not to what the chunk says
/// Throws std::bad_alloc.
[[nodiscard]] Decompressed decompress(std::string_view compression,
                                      std::span<const std::uint8_t> packed, std::uint64_t size,
                                      std::vector<std::uint8_t>& buffer);

}  // namespace seqloop::bags
