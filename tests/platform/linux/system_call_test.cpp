// SPDX-License-Identifier: MIT
// The match stage asks nothing of the system: a process that is killed for any system call lives.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <functional>

#include "core/matcher.hpp"

namespace seqloop::live {
namespace {

constexpr int not_permitted = 77;

/// From now on any system call but exit_group kills the process.
bool forbid_system_calls() {
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
int status_without_system_calls(const std::function<bool()>& call) {
  const pid_t child = fork();
  if (child == 0) {
    if (!forbid_system_calls()) _exit(not_permitted);
    _exit(call() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

class SystemCalls : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers make system calls of their own";
#endif
    const int status = status_without_system_calls([] { return true; });
    if (WIFEXITED(status) && WEXITSTATUS(status) == not_permitted) {
      GTEST_SKIP() << "seccomp filters are not permitted here";
    }
    ASSERT_EQ(status, 0);
  }
};

TEST_F(SystemCalls, TheFilterKillsForASingleOne) {
  const int status = status_without_system_calls([] { return syscall(SYS_getppid) >= 0; });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGSYS);
}

TEST_F(SystemCalls, NoStepOfTheDetectorMakesOne) {
  const oracle::Vectors lap = oracle::drive(31, 150, 40, 0.2F);
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const Use use : {Use::localise, Use::close_loops}) {
      MatcherConfig config;
      config.candidates = candidates;
      config.use = use;
      config.exclude = 30;
      PlaceMap map = use == Use::localise ? map_of(lap, config) : PlaceMap(config, {600, 40});
      Detector detector(config, map);
      EXPECT_EQ(status_without_system_calls([&] {
                  std::size_t matched = 0;
                  for (std::size_t frame = 0; frame < 500; ++frame) {
                    matched += detector.step(lap[frame % lap.size()]).match.has_value();
                    if (frame % 50 == 0) detector.skip(frame % 100 == 0 ? 2 : 1000);
                  }
                  return matched > 100;
                }),
                0);
    }
  }
}

}  // namespace
}  // namespace seqloop::live
