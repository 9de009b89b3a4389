// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace seqloop {

/// Something that keeps a set-up from working: what it concerns, why, and what to do about it.
struct Fault {
  std::string what;
  std::string why;
  std::string remedy = {};  ///< empty where none can be given
};

/// Every fault of a set-up at once, in the order in which they were found.
using Faults = std::vector<Fault>;

/// Thrown while setting up, never while stepping. `what()` holds one line a fault.
class SetupError : public std::runtime_error {
 public:
  explicit SetupError(Faults faults);
  explicit SetupError(Fault fault);

  [[nodiscard]] const Faults& faults() const noexcept { return faults_; }

 private:
  Faults faults_;
};

/// `WHAT: WHY; REMEDY`.
[[nodiscard]] std::string to_string(const Fault& fault);

}  // namespace seqloop
