// SPDX-License-Identifier: MIT
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace seqloop::http {

/// A client's socket as the library reads and writes it, with limits that the library has not: a
/// request is here as a whole within `patience` or never, and a reply that nobody takes is dropped.
class Connection : public httplib::Stream {
 public:
  static constexpr std::chrono::seconds patience{5};

  /// @param stopping ends all waiting; lives longer
  Connection(int socket, const std::atomic<bool>& stopping) noexcept
      : socket_(socket), stopping_(&stopping) {}

  enum class Got : std::uint8_t {
    head,
    nothing,   ///< the client is gone, or asks nothing
    too_slow,  ///< it began to ask, and did not come to an end
    too_long   ///< its head has no end within `most_head`
  };

  /// Waits for the next request. @param head line and headers, with the empty line
  [[nodiscard]] Got read_head(std::string& head);

  /// What `read` brings from here on: this head, and as many bytes of the body.
  void pass_on(std::string head, std::size_t body);

  /// Writes all of it. @return false when the client is gone or takes nothing
  bool write_all(std::string_view text);

  [[nodiscard]] std::uint64_t bytes_sent() const noexcept { return bytes_sent_; }

  [[nodiscard]] bool is_readable() const override { return true; }
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* into, size_t size) override;
  ssize_t write(const char* bytes, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  using Time = std::chrono::steady_clock::time_point;

  [[nodiscard]] bool wait(short events, Time until) const;
  /// Adds what comes next. @return false when nothing does until then
  [[nodiscard]] bool receive(Time until);

  int socket_;
  const std::atomic<bool>* stopping_;
  std::string received_;  // and not read yet: at most a head and a buffer
  std::string head_;      // to be read first
  std::size_t head_read_ = 0;
  std::size_t body_left_ = 0;
  Time until_{};  // the request must be here
  std::uint64_t bytes_sent_ = 0;
};

}  // namespace seqloop::http
