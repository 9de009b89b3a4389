// SPDX-License-Identifier: MIT
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>

namespace seqloop::http {

/// A thread for each connection, with a small stack, up to a bound. What comes
/// beyond is run at once by the caller, with `refusing` set.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  /// @param give_way whether they have the lowest priority
  ConnectionThreads(std::size_t most, bool give_way) : most_(most), give_way_(give_way) {}

  void enqueue(std::function<void()> task) override;
  /// Waits for all of them.
  void shutdown() override;

  /// Whether what runs in this thread is to be turned away.
  [[nodiscard]] static bool refusing() noexcept;

 private:
  struct Start;
  static void* run(void* start);
  [[nodiscard]] bool begin(std::function<void()>& task);

  std::size_t most_;
  bool give_way_;
  std::mutex mutex_;
  std::condition_variable none_left_;
  std::size_t running_ = 0;
};

/// The calling thread gives way to all others.
void give_way() noexcept;

}  // namespace seqloop::http
