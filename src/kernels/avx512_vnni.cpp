// SPDX-License-Identifier: MIT
#include "kernels/dots.hpp"
#include "kernels/variants.hpp"
#include "kernels/vnni512.hpp"

namespace seqloop::kernels {

constinit const IntegerKernels avx512_vnni{"avx512-vnni",
                                           &has_avx512_vnni,
                                           &dot<Vnni512Products>,
                                           &dot_column<Vnni512Products>,
                                           &dot_block<Vnni512Products>,
                                           &hamming_avx512,
                                           &hamming_column_avx512,
                                           &sum_diagonals_avx512,
                                           &lowest_lines_avx512,
                                           &sketch_together_avx512};

}  // namespace seqloop::kernels
