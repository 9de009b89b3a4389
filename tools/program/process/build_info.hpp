// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace seqloop::program {

/// `seqloop 0.1.0 (COMMIT)`.
[[nodiscard]] std::string version_line();

/// What tells this program from one built from other sources: the commit, and, where that does not
/// tell (changes that are not committed, no git), the program's own file.
[[nodiscard]] std::string program_state();

/// Processor, compiler and commit, for numbers to be read with.
[[nodiscard]] std::string condition_line();

}  // namespace seqloop::program
