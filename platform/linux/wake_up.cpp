// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/wake_up.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>

#include "seqloop/fault.hpp"

namespace seqloop::live {

WakeUp::WakeUp() : fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (fd_ < 0) {
    throw SetupError({"eventfd", std::generic_category().message(errno),
                      "close files, or raise the limit with `ulimit -n`"});
  }
}

WakeUp::~WakeUp() { close(fd_); }

void WakeUp::call() noexcept { eventfd_write(fd_, 1); }

void WakeUp::wait(Nanoseconds timeout) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  timespec time{};
  time.tv_sec = static_cast<time_t>(seconds.count());
  time.tv_nsec = static_cast<long>((timeout - seconds).count());
  pollfd waited{fd_, POLLIN, 0};
  if (ppoll(&waited, 1, &time, nullptr) <= 0) return;
  eventfd_t calls = 0;
  eventfd_read(fd_, &calls);
}

}  // namespace seqloop::live
