// SPDX-License-Identifier: MIT
#include "experiment/run/jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "program/process/interruption.hpp"
#include "program/process/say.hpp"

namespace seqloop::experiment {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string duration(double seconds) {
  constexpr double longest = 1e9;
  const auto whole = std::lround(std::clamp(seconds, 0.0, longest));
  return whole < 100 ? fmt::format("{} s", whole) : fmt::format("{} min", (whole + 30) / 60);
}

class Workers {
 public:
  Workers(std::string doing, const std::vector<Job>& jobs) : doing_(std::move(doing)), jobs_(jobs) {
    for (const Job& job : jobs) cost_ += job.cost;
  }

  void work() {
    while (const Job* job = take()) {
      const Clock::time_point start = Clock::now();
      try {
        program::stop_if_interrupted();
        job->work();
        tell(*job, seconds_since(start));
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
        return;
      }
    }
  }

  void finish() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const Job* take() {
    const std::scoped_lock lock(mutex_);
    return failure_ || next_ == jobs_.size() ? nullptr : &jobs_[next_++];
  }

  void tell(const Job& job, double seconds) {
    const std::scoped_lock lock(mutex_);
    ++done_;
    done_cost_ += job.cost;
    const double left = seconds_since(start_) * (cost_ - done_cost_) / std::max(done_cost_, 1e-9);
    program::say("{} {}/{}: {} ({}){}", doing_, done_, jobs_.size(), job.name, duration(seconds),
                 done_ < jobs_.size() ? ", about " + duration(left) + " left" : "");
  }

  std::string doing_;
  const std::vector<Job>& jobs_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  double cost_ = 0.0;
  double done_cost_ = 0.0;
  std::exception_ptr failure_;
};

}  // namespace

void do_jobs(const std::string& doing, const std::vector<Job>& jobs, std::size_t threads) {
  Workers workers(doing, jobs);
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min(threads, jobs.size()); ++i) {
      others.emplace_back([&workers] { workers.work(); });
    }
    workers.work();
  }
  workers.finish();
}

}  // namespace seqloop::experiment
