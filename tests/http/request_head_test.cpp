// SPDX-License-Identifier: MIT
#include "http/request_head.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "seqloop/http/address.hpp"

namespace seqloop::http {
namespace {

const Rules rules{{"localhost", "127.0.0.1", "::1"}, false, "correct-horse"};

int status(const std::string& head, const Rules& by = rules) { return check(head, by).status; }

std::string get(const std::string& target,
                const std::string& headers = "Host: localhost:8321\r\n") {
  return "GET " + target + " HTTP/1.1\r\n" + headers + "\r\n";
}
std::string post(const std::string& headers) {
  return "POST /api/control HTTP/1.1\r\nHost: 127.0.0.1:8321\r\n" + headers + "\r\n";
}
const std::string json = "Content-Type: application/json\r\nContent-Length: 2\r\n";
const std::string token = "Authorization: Bearer correct-horse\r\n";

TEST(RequestHead, PassesOnTheLineAndNothingElseOfAPlainRequest) {
  const CheckedHead head = check(
      get("/api/status?a=1", "hOST: localhost\r\nCookie: a=b\r\nRange: bytes=0-1,2-3\r\nX: y\r\n"),
      rules);
  EXPECT_EQ(head.status, 0);
  EXPECT_EQ(head.passed_on, "GET /api/status?a=1 HTTP/1.1\r\n\r\n");
}

TEST(RequestHead, ForeignNamesAreMisdirected) {
  for (const char* ours : {"localhost", "LOCALHOST:1", "127.0.0.1:8321", "[::1]", "[::1]:80"}) {
    EXPECT_EQ(status(get("/", "Host: " + std::string(ours) + "\r\n")), 0) << ours;
  }
  for (const char* foreign : {"evil.example", "evil.example:8321", "localhost.evil.example",
                              "127.0.0.1.evil.example", "10.0.0.1", "localhost:", "localhost:8a",
                              "[::1", "", "::1", "localhost@evil.example", "[localhost]x"}) {
    EXPECT_EQ(status(get("/", "Host: " + std::string(foreign) + "\r\n")), 421) << foreign;
  }
  EXPECT_EQ(status(get("/", "")), 400);
  EXPECT_EQ(status(get("/", "Host: localhost\r\nHost: localhost\r\n")), 400);
  const Rules open{{"robot"}, true, ""};
  EXPECT_EQ(status(get("/", "Host: 10.0.0.1:8321\r\n"), open), 0);
  EXPECT_EQ(status(get("/", "Host: robot:8321\r\n"), open), 0);
  EXPECT_EQ(status(get("/", "Host: evil.example\r\n"), open), 421);
  // As a router may call it.
  EXPECT_EQ(check(get("/", "Host: robot.fritz.box\r\n"), open).why,
            "this server does not go by that name; ask by its IP address");
}

TEST(RequestHead, ChangesNeedTheTokenAndComeFromOurOwnPage) {
  EXPECT_EQ(status(post(json + token)), 0);
  EXPECT_EQ(status(post(json + token + "Origin: http://127.0.0.1:8321\r\n")), 0);
  EXPECT_EQ(status(post(json)), 401);
  EXPECT_EQ(status(post(json + "Authorization: Bearer correct-horsf\r\n")), 401);
  EXPECT_EQ(status(post(json + "Authorization: Bearer correct-hors\r\n")), 401);
  EXPECT_EQ(status(post(json + "Authorization: Bearer \r\n")), 401);
  for (const char* origin :
       {"http://evil.example", "http://127.0.0.1:80", "null", "https://127.0.0.1:8321"}) {
    EXPECT_EQ(status(post(json + token + "Origin: " + origin + "\r\n")), 403) << origin;
  }
  const Rules read_only{{"127.0.0.1"}, false, ""};
  EXPECT_EQ(status(post(json + "Authorization: Bearer \r\n"), read_only), 401);
  EXPECT_EQ(status(post(token + "Content-Length: 2\r\nContent-Type: text/plain\r\n")), 415);
  EXPECT_EQ(status(post(token + "Content-Type: application/json\r\n")), 411);
}

TEST(RequestHead, SizesAreBounded) {
  EXPECT_EQ(status(get("/" + std::string(255, 'a'))), 0);
  EXPECT_EQ(status(get("/" + std::string(256, 'a'))), 414);
  std::string many = "Host: localhost\r\n";
  for (int i = 0; i < 63; ++i) many += "A: b\r\n";
  EXPECT_EQ(status(get("/", many)), 0);
  EXPECT_EQ(status(get("/", many + "A: b\r\n")), 431);
  EXPECT_EQ(status(get("/", "Host: localhost\r\nA: " + std::string(most_head, 'a') + "\r\n")), 431);
  const auto of_length = [&](const std::string& length) {
    return status(
        post(token + "Content-Type: application/json\r\nContent-Length: " + length + "\r\n"));
  };
  EXPECT_EQ(of_length("4096"), 0);
  EXPECT_EQ(of_length("4097"), 413);
  EXPECT_EQ(of_length("99999999999999999999999"), 413);
  for (const char* none : {"-1", "+1", "1 1", "0x10", "", "1,1"})
    EXPECT_EQ(of_length(none), 400) << none;
  EXPECT_EQ(status(get("/", "Host: localhost\r\nContent-Length: 1\r\n")), 400);
  EXPECT_EQ(status("HEAD / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n\r\n"), 400);
}

TEST(RequestHead, WhatIsNoPlainHttpIsRefused) {
  EXPECT_EQ(status("GET / HTTP/1.0\r\nHost: localhost\r\n\r\n"), 505);
  EXPECT_EQ(status("DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n"), 405);
  for (const char* address : {"//..%2f", "http://localhost/", "*", "/a\x01", "/\xC3\xA4", ""}) {
    EXPECT_EQ(status(get(address)), 400) << address;
  }
  for (const char* line : {": a", "a b: c", "a", "A: b\x01", "A: \x7f"}) {
    EXPECT_EQ(status(get("/", "Host: localhost\r\n" + std::string(line) + "\r\n")), 400) << line;
  }
  EXPECT_EQ(status(get("/", "Host: localhost\r\nTransfer-Encoding: chunked\r\n")), 411);
  EXPECT_EQ(status(get("/", "Host: localhost\r\nExpect: 100-continue\r\n")), 417);
  EXPECT_EQ(status(post(json + token + "Content-Encoding: br\r\n")), 415);
  for (const char* text : {"", "\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/1.1\r\n"}) {
    EXPECT_EQ(status(text), 400) << text;
  }
}

TEST(RequestHead, TokensAreTheSameOrNot) {
  EXPECT_TRUE(same_token("abc", "abc"));
  for (const char* other : {"", "a", "ab", "abd", "abcabc", "ABC"})
    EXPECT_FALSE(same_token(other, "abc"));
  EXPECT_FALSE(same_token("", ""));
}

TEST(Address, IsAnIpAddressAndAPort) {
  EXPECT_EQ(parse_address(""), (Address{"127.0.0.1", 8321}));
  EXPECT_EQ(parse_address("0.0.0.0:80"), (Address{"0.0.0.0", 80}));
  EXPECT_EQ(parse_address("[::1]:0"), (Address{"::1", 0}));
  EXPECT_EQ(parse_address("localhost:9"), (Address{"localhost", 9}));
  for (const char* text : {"8321", "robot:80", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536",
                           "::1:80", "[127.0.0.1]:80", "127.0.0.1:80x", ":80", "[]:80"}) {
    EXPECT_THROW(static_cast<void>(parse_address(text)), std::invalid_argument) << text;
  }
  EXPECT_TRUE(is_loopback("127.8.9.1"));
  EXPECT_FALSE(is_loopback("127.evil.example"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_EQ(to_string(Address{"::1", 80}), "[::1]:80");
}

}  // namespace
}  // namespace seqloop::http
