// SPDX-License-Identifier: MIT
#pragma once

namespace seqloop {

/// How often answers were right of which the trace says this, on the drives that numbers were
/// chosen by: a trace is right or wrong as a whole, which the frames along it do not tell. From .95
/// on it is the same. Rises with it. @param probability 0 .. 1 @return 0 .. 1 Work: an exponential
/// and a logarithm. Source: src/README.md, section 6.6.
[[nodiscard]] double calibrated(double probability) noexcept;

/// What is calibrated to this. @param probability 0 .. 1 @return 0 .. 1
[[nodiscard]] double before_calibration(double probability) noexcept;

/// How often the newest frame's likeliest row was right whose log-odds are these, on the drives
/// that numbers were chosen by. From .9 on it is what they say. Rises with them.
/// @param odds log-odds @return 0 .. 1 Work: an exponential. Source: src/README.md, section 6.4.
[[nodiscard]] double calibrated_now(double odds) noexcept;

}  // namespace seqloop
