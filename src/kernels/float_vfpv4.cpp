// SPDX-License-Identifier: MIT
#include "kernels/lane_dots.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

// One value at a time, because NEON of 32-bit ARM takes the smallest numbers for zero. VFPv4 fuses,
// and every processor with NEON kernels has it.
constinit const FloatColumn float_vfpv4{"vfpv4", &has_neon, &lane_dots, &lane_dots_block};

}  // namespace seqloop::kernels
