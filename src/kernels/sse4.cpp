// SPDX-License-Identifier: MIT
#include "kernels/composed_of.hpp"
#include "kernels/highway.hpp"
#include "kernels/sketches.hpp"
#include "kernels/variants.hpp"

namespace seqloop::kernels {

constinit const IntegerKernels sse4 =
    composed_of<HighwayProducts, HighwayDifferences, HighwayLanes>("sse4", &has_sse4, &sketches);

}  // namespace seqloop::kernels
