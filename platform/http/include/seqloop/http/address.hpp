// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace seqloop::http {

/// Where a server is reached.
struct Address {
  std::string host = "127.0.0.1";  ///< an IP address, IPv6 without brackets; or `localhost`
  std::uint16_t port = 8321;       ///< 0: any that is free

  bool operator==(const Address&) const = default;
};

/// `ADDR:PORT`, `[ADDR]:PORT`; empty: the default. Throws std::invalid_argument: why not.
[[nodiscard]] Address parse_address(std::string_view text);

/// Whether only this machine reaches it.
[[nodiscard]] bool is_loopback(std::string_view host) noexcept;

/// Whether it is written as an IP address, IPv6 without brackets.
[[nodiscard]] bool is_ip(std::string_view host) noexcept;

/// `127.0.0.1:8321`, `[::1]:8321`.
[[nodiscard]] std::string to_string(const Address& address);

}  // namespace seqloop::http
