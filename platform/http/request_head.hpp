// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::http {

/// Who may ask, and who may change something.
struct Rules {
  std::vector<std::string> hosts;  ///< names, without port, by which the server may be called
  bool any_ip = false;             ///< or by any IP address
  std::string token;               ///< what changes need; empty: nothing may be changed
};

constexpr std::size_t most_head = 8192;  ///< bytes of a request's line and headers
constexpr std::size_t most_body = 4096;  ///< bytes of a request's body

/// What a request's head was found to be.
struct CheckedHead {
  int status = 0;         ///< 0: to be answered; otherwise what it is refused with
  std::string_view why;   ///< of a refusal, a sentence
  std::string passed_on;  ///< the line, and of the headers what the library needs to see
  std::size_t body = 0;   ///< bytes that follow the head
};

/// Looks at everything that a client says before the library does: only what is known to be good is
/// passed on. One Host that is ours; GET or HEAD without a body, or POST of JSON with its length,
/// our own Origin and the token.
/// @param head line and headers, with the empty line behind them
/// Work: linear. Allocates: what is passed on. Errors: none thrown but for want of memory.
[[nodiscard]] CheckedHead check(std::string_view head, const Rules& rules);

/// Whether both are the same; takes the same time wherever they differ.
/// Work: the length of `given`.
[[nodiscard]] bool same_token(std::string_view given, std::string_view token) noexcept;

}  // namespace seqloop::http
