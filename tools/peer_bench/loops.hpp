// SPDX-License-Identifier: MIT
#pragma once

#include "program/options/verb.hpp"

namespace seqloop::peers {

/// Runs a peer over a drive, and writes what it guesses for each frame, how long that took, and how
/// much memory it has by then. Nothing is accepted here: tools/peers does that.
[[nodiscard]] program::Verb loops_verb();

}  // namespace seqloop::peers
