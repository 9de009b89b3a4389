// SPDX-License-Identifier: MIT
#include "kernels/lane_dots.hpp"
#include "kernels/lowest_lines.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

struct File {};
using Lanes = OneLane<File, float, double>;

bool always() noexcept { return true; }

}  // namespace

constinit const FloatKernels float_plain{
    "plain", &always, &lane_dots, &lane_dots_block, &sum_diagonals<Lanes>, &lowest_lines<Lanes>};

}  // namespace seqloop::kernels
