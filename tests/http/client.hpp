// SPDX-License-Identifier: MIT
#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace seqloop::http::test {

/// A client that says whatever it is told to say.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0;
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  Client(Client&&) = delete;
  Client& operator=(Client&&) = delete;
  ~Client() { ::close(socket_); }

  [[nodiscard]] bool connected() const { return connected_; }

  bool send(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t size = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (size <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(size));
    }
    return true;
  }
  void say_no_more() const { ::shutdown(socket_, SHUT_WR); }

  /// The next reply as a whole; what came until then when the server closed or said nothing in
  /// time.
  /// @param complete whether it is one, by its own length
  std::string reply(bool& complete, int wait_ms = 8000) {
    std::string text;
    complete = false;
    while (true) {
      const std::size_t end = received_.find("\r\n\r\n");
      if (end != std::string::npos) {
        const std::size_t at = received_.find("Content-Length: ");
        const std::size_t body =
            at < end ? std::strtoul(received_.c_str() + at + 16, nullptr, 10) : 0;
        if (received_.size() >= end + 4 + body) {
          text = received_.substr(0, end + 4 + body);
          received_.erase(0, text.size());
          complete = true;
          return text;
        }
      }
      if (!receive(wait_ms)) return received_;
    }
  }

  /// Reads on. @return false when nothing came in time, or the server closed
  bool receive(int wait_ms) {
    pollfd state{socket_, POLLIN, 0};
    if (::poll(&state, 1, wait_ms) <= 0) return false;
    std::array<char, 4096> buffer;
    const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (size <= 0) {
      closed_ = true;
      return false;
    }
    received_.append(buffer.data(), static_cast<std::size_t>(size));
    return true;
  }
  [[nodiscard]] const std::string& received() const { return received_; }
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  int socket_;
  bool connected_ = false;
  bool closed_ = false;
  std::string received_;
};

}  // namespace seqloop::http::test
