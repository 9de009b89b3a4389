// SPDX-License-Identifier: MIT
#include "kernels/lane_squares.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

// One value at a time, because NEON of 32-bit ARM takes the smallest numbers for zero. VFPv4 fuses,
// and every processor with NEON kernels has it.
constinit const FloatColumn float_vfpv4{"vfpv4", &has_neon, &lane_squares, &lane_squares_block};

}  // namespace seqloop::kernels
