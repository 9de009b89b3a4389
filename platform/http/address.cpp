// SPDX-License-Identifier: MIT
#include "seqloop/http/address.hpp"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <stdexcept>

namespace seqloop::http {
namespace {

/// @param family AF_INET or AF_INET6
bool is_ip_of(int family, std::string_view host) noexcept {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (host.size() >= text.size()) return false;
  host.copy(text.data(), host.size());
  in6_addr address{};
  return inet_pton(family, text.data(), &address) == 1;
}

}  // namespace

bool is_ip(std::string_view host) noexcept {
  return is_ip_of(AF_INET, host) || is_ip_of(AF_INET6, host);
}

bool is_loopback(std::string_view host) noexcept {
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && is_ip_of(AF_INET, host));
}

Address parse_address(std::string_view text) {
  Address address;
  if (text.empty()) return address;
  const auto refuse = [&](const char* why) {
    throw std::invalid_argument("'" + std::string(text) + "' " + why);
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) refuse("is no ADDR:PORT, such as 127.0.0.1:8321");
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (port.empty() || error != std::errc() || end != port.data() + port.size()) {
    refuse("has no port of 0 to 65535 behind its last colon");
  }
  const bool brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (brackets) host = host.substr(1, host.size() - 2);
  // A name could lead anywhere, and elsewhere tomorrow.
  if (host != "localhost" && !is_ip_of(brackets ? AF_INET6 : AF_INET, host)) {
    refuse("has no IP address in front of its port; IPv6 stands in brackets");
  }
  address.host = host;
  return address;
}

std::string to_string(const Address& address) {
  const bool brackets = address.host.find(':') != std::string::npos;
  return (brackets ? '[' + address.host + ']' : address.host) + ':' + std::to_string(address.port);
}

}  // namespace seqloop::http
