// SPDX-License-Identifier: MIT
// The server over loopback: what it answers, what it refuses, and that it cannot be worn out.
#include "seqloop/http/server.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "expect_setup_error.hpp"
#include "http/client.hpp"

namespace seqloop::http::test {
namespace {

using namespace std::chrono_literals;
using seqloop::test::says;
using seqloop::test::setup_error;

class FakeSite : public Site {
 public:
  Reply get(std::string_view path, std::string_view query) override {
    if (path == "/throw") throw std::runtime_error("in the site");
    if (path == "/") return {200, "text/html; charset=utf-8", "page"};
    if (path == "/large") return {200, "text/plain", std::string(8'000'000, 'x')};
    return {path == "/query" ? 200 : 404, "text/plain", std::string(query)};
  }
  Reply post(std::string_view path, std::string_view body) override {
    ++posts;
    return {200, "text/plain", std::string(path) + ' ' + std::string(body)};
  }
  std::shared_ptr<const std::string> event(std::uint64_t& last) override {
    std::this_thread::sleep_for(5ms);
    return std::make_shared<const std::string>("data: " + std::to_string(++last) + "\n\n");
  }
  std::atomic<int> posts{0};
};

class ServerTest : public testing::Test {
 protected:
  [[nodiscard]] std::uint16_t port() const { return server_.address().port; }
  [[nodiscard]] std::string ask(const std::string& request) const {
    Client client(port());
    client.send(request);
    bool complete = false;
    return client.reply(complete);
  }
  static std::string get(const std::string& target) {
    return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
  }
  /// Waits for connections that were closed at this end to be gone at the other.
  void settle() const {
    for (int i = 0; i < 2000 && server_.counts().connections > 0; ++i)
      std::this_thread::sleep_for(5ms);
    EXPECT_EQ(server_.counts().connections, 0U);
  }

  FakeSite site_;
  // At no low priority: beside other tests every answer would take its time.
  Server server_{{"127.0.0.1", 0}, "token", site_, Priority::normal};
};

std::size_t descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::size_t resident_pages() {
  std::ifstream statm("/proc/self/statm");
  std::size_t all = 0;
  std::size_t resident = 0;
  statm >> all >> resident;
  return resident;
}

TEST_F(ServerTest, AnswersWithItsManners) {
  const std::string page = ask(get("/"));
  EXPECT_TRUE(page.starts_with("HTTP/1.1 200")) << page;
  EXPECT_TRUE(page.ends_with("\r\n\r\npage")) << page;
  for (const std::string& reply :
       {page, ask(get("/gone")), ask("GET / HTTP/1.1\r\nHost: x.y\r\n\r\n")}) {
    for (const char* header : {"Content-Security-Policy: default-src 'none'; script-src 'self';",
                               "X-Content-Type-Options: nosniff", "Cache-Control: no-store"}) {
      EXPECT_NE(reply.find(header), std::string::npos) << header << '\n' << reply;
    }
    EXPECT_EQ(reply.find("unsafe"), std::string::npos);
    EXPECT_EQ(reply.find("Access-Control"), std::string::npos);
  }
  EXPECT_TRUE(ask(get("/query?a=b")).ends_with("\r\n\r\na=b"));
  EXPECT_TRUE(ask(get("/throw")).starts_with("HTTP/1.1 500"));
  EXPECT_TRUE(ask(get("/../etc/passwd")).starts_with("HTTP/1.1 404"));
  EXPECT_TRUE(ask("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n").starts_with("HTTP/1.1 421"));
}

TEST_F(ServerTest, HeadIsAnsweredAsGetWithoutTheBody) {
  const auto all = [&](const std::string& requests) {
    Client client(port());
    client.send(requests);
    while (client.receive(8000)) {
    }
    return client.received();
  };
  const std::string host = " HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string closing = "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  for (const char* target : {"/", "/api/events"}) {
    const std::string both = all(std::string("HEAD ") + target + host + closing);
    EXPECT_TRUE(both.starts_with("HTTP/1.1 200")) << both;
    EXPECT_NE(both.find("\r\n\r\nHTTP/1.1 200"), std::string::npos) << both;
    EXPECT_TRUE(both.ends_with("\r\n\r\npage")) << both;
  }
  EXPECT_NE(all("HEAD /" + host + closing).find("Content-Length: 4\r\n"), std::string::npos);
  EXPECT_TRUE(all("HEAD /gone" + host + closing).starts_with("HTTP/1.1 404"));
  const std::string refused = all("HEAD / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  EXPECT_TRUE(refused.starts_with("HTTP/1.1 421")) << refused;
  EXPECT_TRUE(refused.ends_with("\r\n\r\n")) << refused;
  const std::string unknown = ask("DELETE /" + host);
  EXPECT_TRUE(unknown.starts_with("HTTP/1.1 405")) << unknown;
  EXPECT_NE(unknown.find("\r\nAllow: GET, HEAD, POST\r\n"), std::string::npos) << unknown;
}

TEST_F(ServerTest, OneConnectionAsksAgainAndAgain) {
  Client client(port());
  // Two at once: the second must not be lost.
  ASSERT_TRUE(client.send(get("/query?1") + get("/query?2")));
  bool complete = false;
  EXPECT_TRUE(client.reply(complete).ends_with("\r\n\r\n1"));
  EXPECT_TRUE(client.reply(complete).ends_with("\r\n\r\n2"));
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(client.send(get("/query?n=" + std::to_string(i))));
    ASSERT_TRUE(client.reply(complete).ends_with("n=" + std::to_string(i)));
  }
}

TEST_F(ServerTest, TakesChangesWithTheTokenAlone) {
  const auto post = [&](const std::string& headers) {
    return ask(
        "POST /do HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: 2\r\n" +
        headers + "\r\n{}");
  };
  EXPECT_TRUE(post("").starts_with("HTTP/1.1 401"));
  EXPECT_TRUE(post("").ends_with(
      "\r\n\r\n{\"error\":\"changes need the token that was printed at the start\"}"));
  EXPECT_NE(post("").find("Content-Type: application/json\r\n"), std::string::npos);
  EXPECT_TRUE(post("Authorization: Bearer tokem\r\n").starts_with("HTTP/1.1 401"));
  EXPECT_TRUE(
      post("Authorization: Bearer token\r\nOrigin: http://evil\r\n").starts_with("HTTP/1.1 403"));
  EXPECT_EQ(site_.posts, 0);
  EXPECT_TRUE(
      post("Authorization: Bearer token\r\nOrigin: http://localhost\r\n").ends_with("/do {}"));
  EXPECT_EQ(site_.posts, 1);
}

TEST_F(ServerTest, EventsComeAndAClientThatVanishesIsForgotten) {
  {
    Client client(port());
    client.send(get("/api/events"));
    while (client.received().find("data: 20\n\n") == std::string::npos)
      ASSERT_TRUE(client.receive(5000));
    EXPECT_NE(client.received().find("text/event-stream"), std::string::npos);
  }
  settle();
}

TEST_F(ServerTest, ClientsThatStallOrDribbleAreDropped) {
  Client stalled(port());
  stalled.send(get("/large"));  // and takes nothing of it
  Client dribbling(port());
  dribbling.send("GET / HTTP/1.1\r\n");
  Client silent(port());
  const auto begin = std::chrono::steady_clock::now();
  while (dribbling.send("A: b\r\n") && !dribbling.receive(250)) {
    ASSERT_LT(std::chrono::steady_clock::now() - begin, 60s);
  }
  EXPECT_TRUE(dribbling.received().empty() || dribbling.received().starts_with("HTTP/1.1 408"));
  settle();
}

TEST_F(ServerTest, NoMoreThanItsConnections) {
  std::vector<std::unique_ptr<Client>> clients;
  for (std::size_t i = 0; i < Server::most_connections; ++i) {
    clients.push_back(std::make_unique<Client>(port()));
    clients.back()->send(get("/api/events"));
    ASSERT_TRUE(clients.back()->receive(10'000)) << i;
  }
  bool complete = false;
  Client one_more(port());
  EXPECT_TRUE(one_more.reply(complete).starts_with("HTTP/1.1 503"));
  clients.clear();
  settle();
  EXPECT_TRUE(ask(get("/")).ends_with("page"));
}

TEST_F(ServerTest, ATakenPortIsAnError) {
  FakeSite other;
  for (const Address& address : {Address{"127.0.0.1", port()}, Address{"192.0.2.1", 0}}) {
    EXPECT_TRUE(says(setup_error([&] { const Server second(address, "", other); }),
                     "cannot be listened on"));
  }
}

/// Requests that are nearly right.
class Rubbish {
 public:
  explicit Rubbish(unsigned seed) : random_(seed) {}

  std::string next() {
    static const std::array<std::string, 4> good{
        "GET / HTTP/1.1\r\nHost: localhost\r\nAccept: */*\r\n\r\n",
        "GET /query?a=1&b=2 HTTP/1.1\r\nHost: 127.0.0.1:8321\r\nRange: bytes=0-1\r\n\r\n",
        "POST /do HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer token\r\nContent-Type: "
        "application/json\r\nContent-Length: 7\r\n\r\n{\"a\":1}",
        "GET /api/status HTTP/1.1\r\nHost: [::1]\r\nConnection: keep-alive\r\nCookie: x\r\n\r\n"};
    static const std::array<std::string, 10> words{"\r\n",
                                                   "\r\n\r\n",
                                                   "Content-Length: 9999999999999999999\r\n",
                                                   "Transfer-Encoding: chunked\r\n",
                                                   "\xFF\xFE",
                                                   "%00%2e%2e",
                                                   "HTTP/9.9",
                                                   "Host: evil\r\n",
                                                   "Content-Encoding: br\r\n",
                                                   "Range: bytes=0-,-,-,-,-,-\r\n"};
    std::string text = good[below(good.size())];
    for (std::size_t changes = below(4); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size());
      switch (below(6)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, below(20));
          break;
        case 2:
          text.insert(at, words[below(words.size())]);
          break;
        case 3:
          text.insert(at, std::string(below(9000), static_cast<char>(below(256))));
          break;
        case 4:
          text.insert(at, text.substr(below(text.size()), below(60)));
          break;
        default:
          text.resize(at);
          break;
      }
    }
    return text;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }
  std::mt19937 random_;
};

/// Whether it looks like a request that wants an answer.
bool whole(const std::string& request) {
  const std::size_t end = request.find("\r\n\r\n");
  constexpr std::size_t body = 7;
  return end != std::string::npos &&
         (!request.starts_with("POST") || request.size() >= end + 4 + body);
}

TEST_F(ServerTest, RubbishIsAnsweredOrTurnedAwayAndLeavesNothingBehind) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr int requests = 4'000;
#else
  constexpr int requests = 20'000;
#endif
  constexpr unsigned seed = 16;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Rubbish rubbish(seed);
  std::unique_ptr<Client> client;
  int again = 0;
  int answered = 0;
  std::size_t open = 0;
  [[maybe_unused]] std::size_t pages = 0;  // not looked at under sanitizers
  for (int i = 0; i < requests; ++i) {
    if (i == requests / 4) {
      client.reset();
      settle();
      open = descriptors();
      pages = resident_pages();
    }
    if (client) {
      ++again;
    } else {
      client = std::make_unique<Client>(port());
    }
    ASSERT_TRUE(client->connected()) << i;
    const std::string request = rubbish.next();
    const bool sent = client->send(request);
    // Half a request is not waited for, though the server would.
    bool complete = false;
    std::string reply;
    if (whole(request)) reply = client->reply(complete, 300);
    if (!complete && !client->closed()) {
      client->say_no_more();
      reply = client->reply(complete);
    }
    if (complete) {
      ++answered;
      ASSERT_TRUE(reply.starts_with("HTTP/1.1 ")) << i << '\n' << reply;
    }
    if (!sent || !complete || reply.find("Connection: close") != std::string::npos) client.reset();
  }
  client.reset();
  settle();
  EXPECT_EQ(descriptors(), open);
  EXPECT_GT(again, requests / 10) << "connections are used again";
  EXPECT_GT(answered, requests / 4);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(resident_pages(), pages + 1024) << "4 MiB";
#endif
  EXPECT_TRUE(ask(get("/")).ends_with("page"));
}

}  // namespace
}  // namespace seqloop::http::test
