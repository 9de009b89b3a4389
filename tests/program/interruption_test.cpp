// SPDX-License-Identifier: MIT
#include "program/process/interruption.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

namespace seqloop::program {
namespace {

/// Asks this process to stop by a signal that another thread takes, then waits to hear of it.
void be_interrupted_in_another_thread() {
  take_interruptions();
  ::alarm(30);  // ends the process if it never hears
  std::atomic<bool> heard = false;
  std::thread worker([&heard] {
    ::pthread_kill(::pthread_self(), SIGTERM);
    while (!heard.load(std::memory_order_relaxed)) std::this_thread::yield();
  });
  while (!interrupted()) std::this_thread::yield();
  heard.store(true, std::memory_order_relaxed);
  worker.join();
}

// Under the thread sanitizer this is the race of a handler and a loop in two threads.
TEST(Interruption, IsHeardWhicheverThreadTheSystemGivesTheSignal) {
  EXPECT_EXIT((be_interrupted_in_another_thread(), std::exit(0)), testing::ExitedWithCode(0), "");
}

/// Is asked twice at once, as by `timeout`, and again after a while.
void be_interrupted_again_and_again() {
  take_interruptions();
  ::raise(SIGINT);
  ::raise(SIGTERM);
  std::fputs("goes on", stderr);
  std::this_thread::sleep_for(std::chrono::milliseconds(1'100));
  ::raise(SIGTERM);
  std::_Exit(interrupted() ? 1 : 2);
}

TEST(Interruption, OfSignalsThatComeTogetherOneCounts) {
  EXPECT_EXIT(be_interrupted_again_and_again(), testing::KilledBySignal(SIGTERM), "goes on");
}

}  // namespace
}  // namespace seqloop::program
