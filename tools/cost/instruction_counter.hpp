// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop::cost {

/// Counts the instructions that this thread executes, those of the kernel for it left out.
class InstructionCounter {
 public:
  /// Throws SetupError where the kernel or its machine cannot count them.
  InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;
  InstructionCounter(InstructionCounter&&) = delete;
  InstructionCounter& operator=(InstructionCounter&&) = delete;
  ~InstructionCounter();

  /// @return instructions of `work()`, without those of counting
  template <typename Work>
  [[nodiscard]] std::uint64_t count(Work&& work) const {
    const std::uint64_t before = executed();
    work();
    return executed() - before - own_;
  }

 private:
  [[nodiscard]] std::uint64_t executed() const;

  int counter_;
  std::uint64_t own_ = 0;
};

}  // namespace seqloop::cost
