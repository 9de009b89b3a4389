// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "seqloop/files/npy_file.hpp"

namespace seqloop::program {

/// Brings every row to unit length, as Algorithm 1 wants it. What is unit to rounding, and what is
/// all zero, stays as it is, bit by bit.
/// @return rows that were changed
std::size_t normalise_rows(files::Matrix& matrix) noexcept;

}  // namespace seqloop::program
