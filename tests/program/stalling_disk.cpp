// SPDX-License-Identifier: MIT
// Loaded into a program, it makes each sync wait while a file named by SEQLOOP_STALL is there.
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

namespace {

void stall() {
  const char* const sign = ::getenv("SEQLOOP_STALL");
  constexpr unsigned pause_us = 10'000;
  while (sign != nullptr && ::access(sign, F_OK) == 0) ::usleep(pause_us);
}

}  // namespace

extern "C" int fsync(int file) {
  stall();
  return static_cast<int>(::syscall(SYS_fsync, file));
}

extern "C" int fdatasync(int file) {
  stall();
  return static_cast<int>(::syscall(SYS_fdatasync, file));
}
