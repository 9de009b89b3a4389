// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "seqloop/http/address.hpp"

namespace seqloop::http {

struct Reply {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
};

/// Port: what a server shows. Called by many threads at once; what it throws becomes a reply 500.
class Site {
 public:
  Site() = default;
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;
  Site(Site&&) = delete;
  Site& operator=(Site&&) = delete;
  virtual ~Site() = default;

  /// @param path up to the question mark; printable ASCII without `%`, 256 characters at most
  /// @param query what is behind it, likewise
  [[nodiscard]] virtual Reply get(std::string_view path, std::string_view query) = 0;

  /// Something is to be changed, by somebody who has the token. @param body 4,096 bytes at most
  [[nodiscard]] virtual Reply post(std::string_view path, std::string_view body) = 0;

  /// Waits a second at most for the next event.
  /// @param last the number of the last one that this client had, 0 at first; becomes the new one's
  /// @return the event as it is sent (`data: …` and an empty line); null: there was none
  [[nodiscard]] virtual std::shared_ptr<const std::string> event(std::uint64_t& last) = 0;
};

/// How a server's threads are scheduled.
enum class Priority : std::uint8_t {
  low,    ///< behind everything else
  normal  ///< as whoever made it
};

/// What a server has done so far.
struct ServerCounts {
  std::uint64_t connections = 0;  ///< that are open now
  std::uint64_t requests = 0;     ///< that were answered
  std::uint64_t refused = 0;      ///< requests and connections that were turned away
  std::uint64_t bytes_sent = 0;
};

/// Serves a site over HTTP/1.1, in a thread a connection. `/api/events` is its stream of events.
/// 64 connections at most; a request is here within 5 s, of 8 KiB and a body of 4 KiB at most; a
/// client that takes nothing for 10 s is dropped. It answers to its own names only (421), and takes
/// changes with the token only, and not from other sites' pages.
class Server {
 public:
  static constexpr std::size_t most_connections = 64;

  /// Listens from here on. @param token what changes need; empty: nothing can be changed
  /// @param site lives longer
  /// Throws SetupError: the address is not this machine's, or is taken.
  Server(const Address& address, std::string token, Site& site, Priority priority = Priority::low);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  Server(Server&&) = delete;
  Server& operator=(Server&&) = delete;
  ~Server();  ///< ends all connections

  /// With the port that was taken.
  [[nodiscard]] const Address& address() const noexcept;

  [[nodiscard]] ServerCounts counts() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::http
