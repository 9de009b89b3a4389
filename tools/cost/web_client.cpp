// SPDX-License-Identifier: MIT
#include "cost/web_client.hpp"

#include <arpa/inet.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

namespace seqloop::cost {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

class Client {
 public:
  Client(std::uint16_t port, std::atomic<std::uint64_t>& bytes) : port_(port), bytes_(&bytes) {}

  /// As the page does: events as they come, and what it asks for beside them.
  void browse() {
    const int events = request("/api/events");
    std::string newest;
    Clock::time_point asked{};
    while (take(events, newest)) {
      constexpr std::size_t most = 65536;
      if (newest.size() > most) newest.erase(0, newest.size() - most);
      if (Clock::now() - asked < 1500ms) continue;
      asked = Clock::now();
      fetch("/api/loops?first=0&count=12");
      constexpr std::string_view key = "\"newest_picture\":";
      const std::size_t at = newest.rfind(key);
      if (at == std::string::npos) continue;
      const std::string number = newest.substr(at + key.size(), 20);
      fetch("/api/picture?of=frame&number=" + number.substr(0, number.find_first_of(",}")));
    }
  }

 private:
  /// @return a connection on which it has been asked; tries until the server is there
  [[nodiscard]] int request(const std::string& path) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    while (true) {
      const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (connect(line, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
        const std::string text =
            "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
        static_cast<void>(send(line, text.data(), text.size(), MSG_NOSIGNAL));
        return line;
      }
      close(line);
      std::this_thread::sleep_for(50ms);
    }
  }

  [[nodiscard]] bool take(int line, std::string& text) const {
    std::array<char, 65536> some;
    const ssize_t count = recv(line, some.data(), some.size(), 0);
    if (count <= 0) return false;
    *bytes_ += static_cast<std::uint64_t>(count);
    text.append(some.data(), static_cast<std::size_t>(count));
    return true;
  }

  void fetch(const std::string& path) const {
    const int line = request(path);
    std::string reply;
    while (take(line, reply)) {
    }
    close(line);
  }

  std::uint16_t port_;
  std::atomic<std::uint64_t>* bytes_;
};

}  // namespace

WebClients::WebClients(std::size_t count, std::uint16_t port) {
  void* const shared =
      mmap(nullptr, sizeof(*bytes_), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  bytes_ = new (shared) std::atomic<std::uint64_t>(0);
  for (std::size_t n = 0; n < count; ++n) {
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("no process for a client");
    if (process == 0) {
      Client(port, *bytes_).browse();
      _exit(0);
    }
    processes_.push_back(process);
  }
}

WebClients::~WebClients() {
  for (const pid_t process : processes_) {
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
  munmap(bytes_, sizeof(*bytes_));
}

}  // namespace seqloop::cost
