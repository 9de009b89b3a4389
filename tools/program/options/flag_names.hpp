// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/fault.hpp"

namespace seqloop::program {

/// A fault of the library's configuration in the program's words: members by their flags. Any
/// other fault stays as it is.
[[nodiscard]] Fault in_flags(Fault fault);

/// A fault of a TOML file: where it names a flag, as in `--ds 5`, it names the key instead, `'ds'
/// 5`.
[[nodiscard]] Fault in_keys(Fault fault);

}  // namespace seqloop::program
