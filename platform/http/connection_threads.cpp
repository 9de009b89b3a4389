// SPDX-License-Identifier: MIT
#include "http/connection_threads.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <memory>
#include <utility>

namespace seqloop::http {
namespace {

thread_local bool refuses = false;
constexpr std::size_t stack_size = 512U * 1024U;  // with locked memory all of it is resident

}  // namespace

struct ConnectionThreads::Start {
  ConnectionThreads* threads;
  std::function<void()> task;
};

bool ConnectionThreads::refusing() noexcept { return refuses; }

void give_way() noexcept {
  const sched_param none{};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_BATCH, &none));
  constexpr int last = 19;
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), last));
}

void* ConnectionThreads::run(void* start) {
  std::unique_ptr<Start> own(static_cast<Start*>(start));
  if (own->threads->give_way_) give_way();
  own->task();
  ConnectionThreads* const threads = own->threads;
  own.reset();
  const std::scoped_lock lock(threads->mutex_);
  if (--threads->running_ == 0) threads->none_left_.notify_all();
  return nullptr;
}

bool ConnectionThreads::begin(std::function<void()>& task) {
  pthread_attr_t how;
  if (pthread_attr_init(&how) != 0) return false;
  pthread_attr_setdetachstate(&how, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&how, stack_size);
  auto start = std::make_unique<Start>(Start{this, std::move(task)});
  pthread_t thread{};
  const bool begun = pthread_create(&thread, &how, run, start.get()) == 0;
  pthread_attr_destroy(&how);
  if (begun) {
    static_cast<void>(start.release());  // the thread's own
  } else {
    task = std::move(start->task);
  }
  return begun;
}

void ConnectionThreads::enqueue(std::function<void()> task) {
  {
    const std::scoped_lock lock(mutex_);
    if (running_ < most_ && begin(task)) {
      ++running_;
      return;
    }
  }
  refuses = true;
  task();
  refuses = false;
}

void ConnectionThreads::shutdown() {
  std::unique_lock lock(mutex_);
  none_left_.wait(lock, [this] { return running_ == 0; });
}

}  // namespace seqloop::http
