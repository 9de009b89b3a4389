// SPDX-License-Identifier: MIT
#include "kernels/lane_dots.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {
namespace {

bool always() noexcept { return true; }

}  // namespace

constinit const FloatColumn float_plain{"plain", &always, &lane_dots, &lane_dots_block};

}  // namespace seqloop::kernels
