// SPDX-License-Identifier: MIT
#include "seqloop/linux/real_time.hpp"

#include <linux/capability.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <string>
#include <system_error>

namespace seqloop::live {
namespace {

constexpr const char* unlimited = "unlimited";

std::string message(int error) { return std::generic_category().message(error); }

/// How the right to do something is granted.
std::string remedy(std::string_view capability, std::string_view limit, std::string_view value,
                   std::string_view systemd) {
  std::string text = "grant it: `sudo setcap ";
  text.append(capability).append("+ep PROGRAM`; or the line `@video - ").append(limit);
  text.append(" ").append(value).append("` in /etc/security/limits.d/seqloop.conf, and log in ");
  text.append("anew; or `").append(systemd).append("` in the systemd unit");
  return text;
}

std::string limit(decltype(RLIMIT_MEMLOCK) resource) {
  rlimit limits{};
  getrlimit(resource, &limits);
  return limits.rlim_cur == RLIM_INFINITY ? unlimited : std::to_string(limits.rlim_cur);
}

/// `0-3,6`
std::string list_of(const cpu_set_t& cpus) {
  std::string text;
  for (std::size_t first = 0; first < CPU_SETSIZE; ++first) {
    if (!CPU_ISSET(first, &cpus)) continue;
    std::size_t last = first;
    while (last + 1 < CPU_SETSIZE && CPU_ISSET(last + 1, &cpus)) ++last;
    text.append(text.empty() ? "" : ",").append(std::to_string(first));
    if (last > first) text.append("-").append(std::to_string(last));
    first = last;
  }
  return text;
}

/// Those that the process is confined to: asked for all, the kernel grants these.
cpu_set_t usable_cpus(const cpu_set_t& present) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &cpus);
  sched_setaffinity(0, sizeof cpus, &cpus);
  sched_getaffinity(0, sizeof cpus, &cpus);
  sched_setaffinity(0, sizeof present, &present);
  return cpus;
}

void set_priority(int priority, std::string_view thread, Faults& faults) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return;
  const std::string number = std::to_string(priority);
  faults.push_back({"real-time priority " + number + " of the " + std::string(thread),
                    message(error) + "; the limit is " + limit(RLIMIT_RTPRIO),
                    remedy("cap_sys_nice", "rtprio", "90", "LimitRTPRIO=90")});
}

void set_cpus(const std::vector<unsigned>& wanted, std::string_view thread, Faults& faults) {
  cpu_set_t before;
  CPU_ZERO(&before);
  sched_getaffinity(0, sizeof before, &before);
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  for (const unsigned cpu : wanted) CPU_SET(cpu, &cpus);
  cpu_set_t granted;
  CPU_ZERO(&granted);
  const int error = sched_setaffinity(0, sizeof cpus, &cpus) == 0 ? 0 : errno;
  sched_getaffinity(0, sizeof granted, &granted);
  if (error == 0 && CPU_EQUAL(&granted, &cpus)) return;
  const cpu_set_t usable = usable_cpus(before);
  faults.push_back(
      {"CPUs " + list_of(cpus) + " for the " + std::string(thread),
       error == EINVAL ? "none of them may be used"
       : error != 0    ? message(error)
                       : "only " + list_of(granted) + " are granted",
       "the process may use " + list_of(usable) +
           "; more are granted by its cpuset (`AllowedCPUs=` of the systemd unit, `--cpuset-cpus` "
           "of a container)"});
}

bool may_lock_without_limit() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> data{};
  if (syscall(SYS_capget, &header, data.data()) == 0 &&
      (data[0].effective & (1U << CAP_IPC_LOCK)) != 0) {
    return true;
  }
  return limit(RLIMIT_MEMLOCK) == unlimited;
}

}  // namespace

Faults validate(const ThreadSettings& settings, std::string_view thread) {
  Faults faults;
  const std::string of = " of the " + std::string(thread);
  if (settings.priority < 0 || settings.priority > 99) {
    faults.push_back({"real-time priority " + std::to_string(settings.priority) + of,
                      "it must be 1 to 99, or 0 to leave the thread as it is"});
  }
  const auto present = static_cast<unsigned>(sysconf(_SC_NPROCESSORS_CONF));
  for (const unsigned cpu : settings.cpus) {
    if (cpu < present) continue;
    faults.push_back({"CPU " + std::to_string(cpu) + of, "there is no such CPU",
                      "this machine has 0 to " + std::to_string(present - 1)});
  }
  return faults;
}

Faults schedule(const ThreadSettings& settings, std::string_view thread) {
  Faults faults;
  if (!settings.cpus.empty()) set_cpus(settings.cpus, thread, faults);
  if (settings.priority > 0) set_priority(settings.priority, thread, faults);
  return faults;
}

Faults lock_memory() {
  errno = EPERM;
  if (may_lock_without_limit() && mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return {{"locking memory", message(errno) + "; the limit is " + limit(RLIMIT_MEMLOCK) + " bytes",
           remedy("cap_ipc_lock", "memlock", "unlimited", "LimitMEMLOCK=infinity")}};
}

Faults keep_freed_memory() {
  constexpr int never = -1;
  if (mallopt(M_TRIM_THRESHOLD, never) == 1 && mallopt(M_MMAP_MAX, 0) == 1) return {};
  return {{"keeping freed memory", "this C library's heap cannot be told to",
           "use glibc's heap: no other one preloaded, no sanitizer"}};
}

void touch_stack() noexcept {
  constexpr std::size_t page = 4096;
  std::array<volatile std::byte, 64 * page> stack;
  for (std::size_t i = 0; i < stack.size(); i += page) stack[i] = std::byte{0};
}

ThreadCounters thread_counters() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt),
          static_cast<std::uint64_t>(usage.ru_nvcsw), static_cast<std::uint64_t>(usage.ru_nivcsw)};
}

}  // namespace seqloop::live
