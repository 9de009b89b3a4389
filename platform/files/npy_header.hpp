// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "seqloop/fault.hpp"

namespace seqloop::files {

/// Where the numbers of a `.npy` file lie, and in which shape.
struct NpyHeader {
  std::uint64_t data_offset = 0;  ///< bytes before the first number
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
};

/// Bytes that always suffice to find the length of a header: magic, version, length.
inline constexpr std::size_t npy_preamble_bytes = 12;

/// @param start the first bytes of the file, at least `npy_preamble_bytes` where it has them
/// @param name the file, for messages
/// @return bytes before the first number. Throws SetupError when this is no `.npy` file.
[[nodiscard]] std::uint64_t npy_data_offset(std::span<const char> start, const std::string& name);

/// @param start exactly the bytes before the first number
/// Throws SetupError with every fault found: number type, order, shape.
[[nodiscard]] NpyHeader parse_npy_header(std::span<const char> start, const std::string& name);

/// A format 1.0 header of 128 bytes, whatever the numbers are.
[[nodiscard]] std::string make_npy_header(std::size_t rows, std::size_t columns);

}  // namespace seqloop::files
