// SPDX-License-Identifier: MIT
// What is asked of the system for real time, and what it says when it refuses.
#include "seqloop/linux/real_time.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "expect_setup_error.hpp"

namespace seqloop::live {
namespace {

using seqloop::test::says;

std::string text_of(const Faults& faults) {
  std::string text;
  for (const Fault& fault : faults) text += to_string(fault) + "\n";
  return text;
}

/// What a call says in a process of its own that may do nothing special.
std::string told_without_rights(const std::function<Faults()>& call) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    for (const auto resource : {RLIMIT_RTPRIO, RLIMIT_MEMLOCK}) {
      const rlimit none{0, 0};
      setrlimit(resource, &none);
    }
    if (geteuid() == 0 && setuid(65534) != 0) _exit(1);
    const std::string text = text_of(call());
    _exit(write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 256> part{};
  for (ssize_t size = 0; (size = read(ends[0], part.data(), part.size())) > 0;) {
    text.append(part.data(), static_cast<std::size_t>(size));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  return text;
}

TEST(RealTime, SettingsThatCannotBeAreToldAllAtOnce) {
  EXPECT_TRUE(validate({}, "work thread").empty());
  EXPECT_TRUE(validate({99, {0}}, "work thread").empty());
  EXPECT_EQ(validate({-1, {}}, "work thread").size(), 1U);
  const Faults faults = validate({100, {0, 4000, 5000}}, "capture thread");
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_TRUE(says(to_string(faults[0]), "real-time priority 100 of the capture thread"));
  EXPECT_TRUE(says(to_string(faults[0]), "1 to 99"));
  EXPECT_TRUE(says(to_string(faults[1]), "CPU 4000 of the capture thread"));
  EXPECT_TRUE(says(to_string(faults[1]), "this machine has 0 to "));
}

TEST(RealTime, ARefusedPrioritySaysHowItIsGranted) {
  const std::string text = told_without_rights([] { return schedule({80, {}}, "capture thread"); });
  for (const char* part :
       {"real-time priority 80 of the capture thread", "the limit is 0", "setcap cap_sys_nice+ep",
        "@video - rtprio 90", "/etc/security/limits.d/", "LimitRTPRIO=90"}) {
    EXPECT_TRUE(says(text, part));
  }
}

TEST(RealTime, RefusedLockingSaysHowItIsGranted) {
  const std::string text = told_without_rights([] { return lock_memory(); });
  for (const char* part : {"locking memory", "the limit is 0 bytes", "setcap cap_ipc_lock+ep",
                           "@video - memlock unlimited", "LimitMEMLOCK=infinity"}) {
    EXPECT_TRUE(says(text, part));
  }
}

TEST(RealTime, CpusThatAreNotGrantedAreToldBesideThoseThatAre) {
  std::thread([] {
    const std::string text = text_of(schedule({0, {1000}}, "work thread"));
    EXPECT_TRUE(says(text, "CPUs 1000 for the work thread"));
    EXPECT_TRUE(says(text, "the process may use 0"));
  }).join();
}

TEST(RealTime, AThreadRunsWhereItIsTold) {
  std::thread([] {
    cpu_set_t before;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    unsigned cpu = 0;
    while (!CPU_ISSET(cpu, &before)) ++cpu;
    EXPECT_EQ(text_of(schedule({0, {cpu}}, "work thread")), "");
    cpu_set_t after;
    ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
    EXPECT_EQ(CPU_COUNT(&after), 1);
    EXPECT_TRUE(CPU_ISSET(cpu, &after));
  }).join();
}

TEST(RealTime, APriorityThatIsGrantedHoldsForThisThreadAlone) {
  std::thread([] {
    const Faults faults = schedule({10, {}}, "work thread");
    if (!faults.empty()) GTEST_SKIP() << text_of(faults);
    EXPECT_EQ(sched_getscheduler(0), SCHED_FIFO);
    sched_param parameters{};
    sched_getparam(0, &parameters);
    EXPECT_EQ(parameters.sched_priority, 10);
  }).join();
  EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
}

TEST(RealTime, CountersCountFaultsAndWaits) {
  constexpr std::size_t page = 4096;
  constexpr std::size_t pages = 64;
  void* const fresh =
      mmap(nullptr, pages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(fresh, MAP_FAILED);
  madvise(fresh, pages * page, MADV_NOHUGEPAGE);
  const ThreadCounters before = thread_counters();
  for (std::size_t i = 0; i < pages; ++i) static_cast<volatile char*>(fresh)[i * page] = 1;
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const ThreadCounters after = thread_counters();
  EXPECT_GE(after.minor_faults - before.minor_faults, pages);
  EXPECT_GE(after.voluntary_switches - before.voluntary_switches, 1U);
  munmap(fresh, pages * page);
}

/// Faults of one use of memory. The kernel takes a page away now and then: what would fault each
/// time does so in all of ten goes.
template <class Use>
std::uint64_t fewest_faults(Use use) {
  std::uint64_t fewest = std::numeric_limits<std::uint64_t>::max();
  for (int go = 0; go < 10; ++go) {
    const ThreadCounters before = thread_counters();
    use();
    fewest = std::min(fewest, thread_counters().minor_faults - before.minor_faults);
  }
  return fewest;
}

TEST(RealTime, TouchedStackFaultsNoMore) {
  std::thread([] {
    touch_stack();
    EXPECT_EQ(fewest_faults(touch_stack), 0U);
  }).join();
}

TEST(RealTime, LockedMemoryIsThereBeforeItIsTouched) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers do not let their memory be locked";
#endif
  const Faults faults = lock_memory();
  if (!faults.empty()) GTEST_SKIP() << text_of(faults);
  constexpr std::size_t bytes = 64 * 4096;
  const auto fresh = [] {
    return static_cast<volatile char*>(
        mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  };
  std::vector<volatile char*> blocks;
  for (int go = 0; go < 10; ++go) blocks.push_back(fresh());
  std::size_t next = 0;
  EXPECT_EQ(fewest_faults([&] {
              volatile char* const block = blocks[next++];
              for (std::size_t i = 0; i < bytes; i += 4096) block[i] = 1;
            }),
            0U);
  for (volatile char* const block : blocks) munmap(const_cast<char*>(block), bytes);
  munlockall();
}

TEST(RealTime, FreedMemoryThatIsKeptComesBackWithoutFaults) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers bring a heap of their own";
#endif
  const Faults faults = keep_freed_memory();
  if (!faults.empty()) GTEST_SKIP() << text_of(faults);
  constexpr std::size_t bytes = 16U << 20U;
  const auto use = [] {
    auto* const memory = static_cast<volatile char*>(std::malloc(bytes));
    for (std::size_t i = 0; i < bytes; i += 4096) memory[i] = 1;
    std::free(const_cast<char*>(memory));
  };
  use();
  EXPECT_EQ(fewest_faults(use), 0U);
}

}  // namespace
}  // namespace seqloop::live
