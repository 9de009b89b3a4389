// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop::cost {

/// Whose instructions are counted: this thread's, or also those of all that it starts from then on.
enum class Whose : std::uint8_t { thread, threads };
/// Whether what the kernel does for them is counted as well.
enum class Where : std::uint8_t { program, program_and_kernel };

/// Counts instructions from when it is made.
class InstructionCounter {
 public:
  /// Throws SetupError where the kernel or its machine cannot count them.
  explicit InstructionCounter(Whose whose = Whose::thread, Where where = Where::program);
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

  /// So far.
  [[nodiscard]] std::uint64_t executed() const;

 private:
  int counter_;
  std::uint64_t own_ = 0;
};

}  // namespace seqloop::cost
