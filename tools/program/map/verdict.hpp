// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop::program {

/// A person's word on a loop.
enum class Verdict : std::uint8_t { none, accepted, rejected };

}  // namespace seqloop::program
