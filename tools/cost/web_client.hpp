// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace seqloop::cost {

/// Browsers that look at a run, each in a process of its own: none of what they do is counted as
/// the server's.
class WebClients {
 public:
  /// They wait for the server to listen. To be made before whatever counts. @param port of it
  WebClients(std::size_t count, std::uint16_t port);
  WebClients(const WebClients&) = delete;
  WebClients& operator=(const WebClients&) = delete;
  WebClients(WebClients&&) = delete;
  WebClients& operator=(WebClients&&) = delete;
  ~WebClients();  ///< ends them

  /// That all have received so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return *bytes_; }

 private:
  std::atomic<std::uint64_t>* bytes_;  // shared with the processes
  std::vector<pid_t> processes_;
};

}  // namespace seqloop::cost
