// SPDX-License-Identifier: MIT
#pragma once

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <functional>

namespace seqloop::test {

inline constexpr int not_permitted = 77;

/// From now on any system call but exit_group kills the process.
inline bool forbid_system_calls() {
  std::array<sock_filter, 4> rules = {{
      {BPF_LD | BPF_W | BPF_ABS, 0, 0, offsetof(seccomp_data, nr)},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, SYS_exit_group},
      {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW},
      {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_KILL_PROCESS},
  }};
  sock_fprog program{rules.size(), rules.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// How a process ends that makes the call without any system call.
inline int status_without_system_calls(const std::function<bool()>& call) {
  const pid_t child = fork();
  if (child == 0) {
    if (!forbid_system_calls()) _exit(not_permitted);
    _exit(call() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

/// Why it cannot be told here whether a system call is made; nothing: it can.
inline const char* system_calls_cannot_be_forbidden() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return "sanitizers make system calls of their own";
#else
  const int status = status_without_system_calls([] { return true; });
  const bool refused = WIFEXITED(status) && WEXITSTATUS(status) == not_permitted;
  return refused ? "seccomp filters are not permitted here" : nullptr;
#endif
}

}  // namespace seqloop::test
