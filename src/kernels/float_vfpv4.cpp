// SPDX-License-Identifier: MIT
#include "kernels/lane_dots.hpp"
#include "kernels/lowest_lines.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct File {};
using Lanes = OneLane<File, float, double>;

}  // namespace

// One value at a time, because NEON of 32-bit ARM takes the smallest numbers for zero. VFPv4 fuses,
// and every processor with NEON kernels has it.
constinit const FloatKernels float_vfpv4{
    "vfpv4", &has_neon, &lane_dots, &lane_dots_block, &sum_diagonals<Lanes>, &lowest_lines<Lanes>};

}  // namespace seqloop::kernels
