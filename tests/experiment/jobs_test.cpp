// SPDX-License-Identifier: MIT
#include "experiment/run/jobs.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

namespace seqloop::experiment {
namespace {

TEST(Jobs, AreAllDoneOnceWhateverTheThreads) {
  for (const std::size_t threads : {1U, 2U, 7U, 300U}) {
    std::vector<std::atomic<int>> done(200);
    std::vector<Job> jobs;
    for (std::atomic<int>& one : done) jobs.push_back({"one", 1.0, [&one] { ++one; }});
    testing::internal::CaptureStderr();
    do_jobs("testing", jobs, threads);
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_NE(told.find("testing 200/200"), std::string::npos);
    for (const std::atomic<int>& one : done) EXPECT_EQ(one, 1);
  }
}

TEST(Jobs, NoneIsNothingToDo) { EXPECT_NO_THROW(do_jobs("testing", {}, 2)); }

TEST(Jobs, ShareTheThreads) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  std::atomic<int> waiting = 0;
  const auto wait_for_both = [&] {
    {
      const std::scoped_lock lock(mutex);
      seen.insert(std::this_thread::get_id());
    }
    ++waiting;
    while (waiting < 2) std::this_thread::yield();
  };
  do_jobs("testing", {{"a", 1.0, wait_for_both}, {"b", 1.0, wait_for_both}}, 2);
  EXPECT_EQ(seen.size(), 2U);
}

TEST(Jobs, StopAtTheFirstFailure) {
  int done = 0;
  const std::vector<Job> jobs{{"good", 1.0, [&] { ++done; }},
                              {"bad", 1.0, [] { throw std::runtime_error("full"); }},
                              {"never", 1.0, [&] { ++done; }}};
  EXPECT_THROW(do_jobs("testing", jobs, 1), std::runtime_error);
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace seqloop::experiment
