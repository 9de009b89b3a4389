// SPDX-License-Identifier: MIT
#include "cost/instruction_counter.hpp"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "seqloop/fault.hpp"

namespace seqloop::cost {
namespace {

int open_counter(Whose whose, Where where) {
  perf_event_attr wanted{};
  wanted.size = sizeof(wanted);
  wanted.type = PERF_TYPE_HARDWARE;
  wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
  wanted.exclude_kernel = where == Where::program ? 1 : 0;
  wanted.inherit = whose == Whose::threads ? 1 : 0;
  wanted.exclude_hv = 1;
  constexpr pid_t this_thread = 0;
  constexpr int any_cpu = -1;
  constexpr int no_group = -1;
  const long counter =
      syscall(SYS_perf_event_open, &wanted, this_thread, any_cpu, no_group, PERF_FLAG_FD_CLOEXEC);
  if (counter < 0) {
    throw SetupError(Fault{"instructions",
                           std::string("the kernel does not count them (") + strerror(errno) + ")",
                           "run it with tests/vm/cost, in a machine that does"});
  }
  return static_cast<int>(counter);
}

}  // namespace

InstructionCounter::InstructionCounter(Whose whose, Where where)
    : counter_(open_counter(whose, where)) {
  own_ = count([] {});
}

InstructionCounter::~InstructionCounter() { close(counter_); }

std::uint64_t InstructionCounter::executed() const {
  std::uint64_t instructions = 0;
  if (read(counter_, &instructions, sizeof(instructions)) != sizeof(instructions)) {
    throw std::runtime_error("the instruction counter cannot be read");
  }
  return instructions;
}

}  // namespace seqloop::cost
