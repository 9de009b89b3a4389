// SPDX-License-Identifier: MIT
#include "http/connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "http/request_head.hpp"

namespace seqloop::http {
namespace {

using std::chrono::steady_clock;

}  // namespace

bool Connection::wait(short events, Time until) const {
  constexpr std::chrono::milliseconds slice(100);  // and then looks whether to stop
  while (!stopping_->load(std::memory_order_relaxed)) {
    const auto left = until - steady_clock::now();
    if (left <= steady_clock::duration::zero()) return false;
    const auto some = std::min(std::chrono::ceil<std::chrono::milliseconds>(left), slice);
    pollfd state{socket_, events, 0};
    const int ready = ::poll(&state, 1, static_cast<int>(some.count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool Connection::receive(Time until) {
  std::array<char, 2048> buffer;
  while (wait(POLLIN, until)) {
    const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size > 0) {
      received_.append(buffer.data(), static_cast<std::size_t>(size));
      return true;
    }
    if (size == 0) return false;
    if (errno != EAGAIN && errno != EINTR) return false;
  }
  return false;
}

Connection::Got Connection::read_head(std::string& head) {
  constexpr std::string_view end_of_head = "\r\n\r\n";
  if (received_.empty() && !receive(steady_clock::now() + patience)) return Got::nothing;
  until_ = steady_clock::now() + patience;
  while (true) {
    const std::size_t end = received_.find(end_of_head);
    if (end != std::string::npos && end + end_of_head.size() <= most_head) {
      head = received_.substr(0, end + end_of_head.size());
      received_.erase(0, head.size());
      return Got::head;
    }
    if (received_.size() > most_head) return Got::too_long;
    if (!receive(until_)) {
      return steady_clock::now() < until_ ? Got::nothing : Got::too_slow;
    }
  }
}

void Connection::pass_on(std::string head, std::size_t body) {
  head_ = std::move(head);
  head_read_ = 0;
  body_left_ = body;
}

ssize_t Connection::read(char* into, size_t size) {
  if (head_read_ < head_.size()) {
    const std::size_t taken = head_.copy(into, size, head_read_);
    head_read_ += taken;
    return static_cast<ssize_t>(taken);
  }
  const std::size_t wanted = std::min(size, body_left_);
  if (wanted == 0) return 0;
  if (received_.empty() && !receive(until_)) return -1;
  const std::size_t taken = received_.copy(into, wanted);
  received_.erase(0, taken);
  body_left_ -= taken;
  return static_cast<ssize_t>(taken);
}

bool Connection::write_all(std::string_view text) {
  const Time until = steady_clock::now() + 2 * patience;
  while (!text.empty()) {
    if (!wait(POLLOUT, until)) return false;
    const ssize_t size = ::send(socket_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (size <= 0) continue;
    text.remove_prefix(static_cast<std::size_t>(size));
    bytes_sent_ += static_cast<std::uint64_t>(size);
  }
  return true;
}

ssize_t Connection::write(const char* bytes, size_t size) {
  return write_all({bytes, size}) ? static_cast<ssize_t>(size) : -1;
}

bool Connection::is_writable() const { return wait(POLLOUT, steady_clock::now() + 2 * patience); }

// Nobody asks who asks.
void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}
void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace seqloop::http
