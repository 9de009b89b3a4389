// SPDX-License-Identifier: MIT
#include "http/request_head.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "seqloop/http/address.hpp"

namespace seqloop::http {
namespace {

constexpr std::size_t most_target = 256;
constexpr std::size_t most_headers = 64;
constexpr std::string_view line_end = "\r\n";

bool is_token_char(char c) {
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return letter || std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_name(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, {}, lower, lower);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// The headers that matter here, each once at most.
struct Headers {
  std::optional<std::string_view> host;
  std::optional<std::string_view> origin;
  std::optional<std::string_view> length;
  std::optional<std::string_view> type;
  std::optional<std::string_view> authorization;
  std::optional<std::string_view> connection;
};

CheckedHead refused(int status, std::string_view why) { return {status, why, {}, 0}; }

/// Without its port. @return nothing where it is no host
std::string_view name_of(std::string_view host) {
  const std::size_t close = host.starts_with('[') ? host.find(']') : std::string_view::npos;
  const std::size_t from = close == std::string_view::npos ? 0 : close;
  const std::string_view port = host.substr(std::min(host.find(':', from), host.size()));
  if (port.size() == 1 || port.find_first_not_of(":0123456789") != std::string_view::npos)
    return {};
  if (std::ranges::count(port, ':') > 1) return {};
  host.remove_suffix(port.size());
  return close == std::string_view::npos ? host : host.substr(1, host.size() - 2);
}

bool is_ours(std::string_view host, const Rules& rules) {
  const std::string_view name = name_of(host);
  if (name.empty()) return false;
  return (rules.any_ip && is_ip(name)) ||
         std::ranges::any_of(rules.hosts,
                             [&](const std::string& ours) { return same_name(name, ours); });
}

/// @return why the line is no header that can be taken; nothing where it can
std::optional<CheckedHead> take(std::string_view line, Headers& headers) {
  const std::size_t colon = line.find(':');
  const std::string_view name = line.substr(0, std::min(colon, line.size()));
  if (name.empty() || colon == std::string_view::npos || !std::ranges::all_of(name, is_token_char))
    return refused(400, "a header has no name");
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (std::ranges::any_of(value, [](char c) {
        return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F;
      }))
    return refused(400, "a header holds control characters");
  if (same_name(name, "transfer-encoding")) return refused(411, "a body needs a Content-Length");
  if (same_name(name, "content-encoding")) return refused(415, "bodies are not unpacked");
  if (same_name(name, "expect")) return refused(417, "nothing is promised beforehand");
  const std::array<std::pair<std::string_view, std::optional<std::string_view>*>, 6> known{
      {{"host", &headers.host},
       {"origin", &headers.origin},
       {"content-length", &headers.length},
       {"content-type", &headers.type},
       {"authorization", &headers.authorization},
       {"connection", &headers.connection}}};
  for (const auto& [which, into] : known) {
    if (!same_name(name, which)) continue;
    if (*into) return refused(400, "a header comes twice");
    *into = value;
  }
  return std::nullopt;
}

/// @return why a request that changes something may not; nothing where it may
std::optional<CheckedHead> refuse_change(const Headers& headers, const Rules& rules) {
  // A browser says from which page a change comes; other programs need not.
  const std::string own = "http://" + std::string(*headers.host);
  if (headers.origin && !same_name(*headers.origin, own))
    return refused(403, "changes are taken from our own page only");
  constexpr std::string_view bearer = "bearer ";
  const std::string_view given = headers.authorization.value_or("");
  const bool has_token = given.size() > bearer.size() &&
                         same_name(given.substr(0, bearer.size()), bearer) &&
                         same_token(trimmed(given.substr(bearer.size())), rules.token);
  if (!has_token) return refused(401, "changes need the token that was printed at the start");
  if (!headers.length) return refused(411, "a body needs a Content-Length");
  const std::string_view type = headers.type.value_or("");
  if (!same_name(trimmed(type.substr(0, type.find(';'))), "application/json"))
    return refused(415, "a body must be application/json");
  return std::nullopt;
}

}  // namespace

bool same_token(std::string_view given, std::string_view token) noexcept {
  if (token.empty()) return false;
  unsigned differs = given.size() == token.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    differs |= static_cast<unsigned>(static_cast<unsigned char>(given[i])) ^
               static_cast<unsigned>(static_cast<unsigned char>(token[i % token.size()]));
  }
  return differs == 0;
}

CheckedHead check(std::string_view head, const Rules& rules) {
  if (head.size() > most_head) return refused(431, "the headers are too long");
  const std::size_t line_size = head.find(line_end);
  if (line_size == std::string_view::npos || !head.ends_with("\r\n\r\n"))
    return refused(400, "this is no HTTP");
  const std::string_view line = head.substr(0, line_size);
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return refused(400, "this is no HTTP");
  const std::string_view method = line.substr(0, first);
  const std::string_view target = line.substr(first + 1, last - first - 1);
  if (line.substr(last + 1) != "HTTP/1.1") return refused(505, "only HTTP/1.1 is spoken here");
  const bool changes = method == "POST";
  if (!changes && method != "GET" && method != "HEAD")
    return refused(405, "only GET, HEAD and POST are known here");
  if (target.size() > most_target) return refused(414, "the address is too long");
  const bool plain = std::ranges::all_of(target, [](char c) { return c > 0x20 && c < 0x7F; });
  if (!target.starts_with('/') || !plain || target.find('%') != std::string_view::npos)
    return refused(400, "the address has characters that none of ours has");

  Headers headers;
  std::size_t count = 0;
  for (std::string_view rest = head.substr(line_size + 2); rest != line_end; ++count) {
    if (count == most_headers) return refused(431, "there are too many headers");
    const std::size_t end = rest.find(line_end);
    if (auto fault = take(rest.substr(0, end), headers)) return *fault;
    rest.remove_prefix(end + 2);
  }
  if (!headers.host) return refused(400, "there is no Host");
  if (!is_ours(*headers.host, rules))
    return refused(421, "this server does not go by that name; ask by its IP address");
  CheckedHead good;
  if (headers.length) {
    const char* const end = headers.length->data() + headers.length->size();
    const auto [at, error] = std::from_chars(headers.length->data(), end, good.body);
    if (error == std::errc::result_out_of_range) return refused(413, "the body is too long");
    if (headers.length->empty() || error != std::errc() || at != end)
      return refused(400, "Content-Length is no length");
  }
  if (good.body > most_body) return refused(413, "the body is too long");
  if (!changes && good.body > 0) return refused(400, "GET and HEAD have no body");
  if (changes) {
    if (auto fault = refuse_change(headers, rules)) return *fault;
  }
  good.passed_on = std::string(line) + "\r\n";
  if (changes) {
    good.passed_on +=
        "Content-Type: application/json\r\nContent-Length: " + std::to_string(good.body) + "\r\n";
  }
  if (headers.connection && same_name(*headers.connection, "close"))
    good.passed_on += "Connection: close\r\n";
  good.passed_on += line_end;
  return good;
}

}  // namespace seqloop::http
