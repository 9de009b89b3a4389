#pragma once

#include <string>

namespace seqloop::program {

/// `seqloop 0.1.0 (COMMIT)`.
[[nodiscard]] std::string version_line();

/// Processor, compiler and commit, for numbers to be read with.
[[nodiscard]] std::string condition_line();

}  // namespace seqloop::program
