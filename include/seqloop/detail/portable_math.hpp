// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop {

/// e^x to about 1e-15 of it, by operations that IEEE 754 defines to the last bit, in one order: the
/// same on every processor, which the C library's is not. @param x finite, taken into -700 .. 700
[[nodiscard]] double exponential(double x) noexcept;

/// The natural logarithm, in the same way. @param x normal, above 0
[[nodiscard]] double logarithm(double x) noexcept;

/// 1 / (1 + e^-x): what a log-odds is as a probability.
[[nodiscard]] inline double logistic(double x) noexcept { return 1.0 / (1.0 + exponential(-x)); }

}  // namespace seqloop
