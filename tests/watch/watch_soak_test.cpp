// SPDX-License-Identifier: MIT
// A long run before clients that come, stall, vanish and talk rubbish: it goes on, nothing grows.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <vector>

#include "http/client.hpp"
#include "program/process/available_memory.hpp"
#include "program/watch/run_site.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t frames = SEQLOOP_SOAK_FRAMES;

std::size_t descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

/// One client after the other, until the run is over.
void disturb(std::uint16_t port, unsigned seed, const std::atomic<bool>& over) {
  std::mt19937 random(seed);
  const std::array<std::string, 7> requests{"GET /api/events",
                                            "GET /api/history",
                                            "GET /metrics",
                                            "GET /api/loops",
                                            "GET /api/picture?of=frame&number=1",
                                            "POST /api/control",
                                            "\xFF\x01 rubbish"};
  while (!over) {
    http::test::Client client(port);
    client.send(requests[random() % requests.size()] + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto doing = random() % 3;
    if (doing == 0) continue;             // vanishes
    if (doing == 1) client.receive(200);  // takes some, and vanishes
    for (int n = 0; doing == 2 && n < 10 && !over; ++n)
      std::this_thread::sleep_for(20ms);  // stalls
  }
}

TEST(WatchSoak, ALongRunBeforeBadClientsTakesNoMoreMemory) {
  const auto watch = std::make_unique<Watch>();
  RunSite site(*watch, {{"source", "soak"}}, true);
  auto server = std::make_unique<http::Server>(http::Address{"127.0.0.1", 0}, "a-token", site,
                                               http::Priority::normal);
  site.serve_by(*server);
  std::atomic<bool> over{false};
  std::thread follower([&] {
    while (!over) {
      site.follow();
      std::this_thread::sleep_for(5ms);
    }
  });
  std::vector<std::thread> clients;
  for (unsigned seed = 1; seed <= 8; ++seed)
    clients.emplace_back(disturb, server->address().port, seed, std::cref(over));

  RunSummary summary(Budget{}, false);
  std::vector<std::uint8_t> pixels(320 * 200);
  std::array<Answer, 1> answers;
  ProcessedFrame processed;
  processed.frame.image = {pixels.data(), 320, 200, 320, PixelFormat::gray8};
  processed.report.answers = answers;
  [[maybe_unused]] std::uint64_t before = 0;  // not compared under sanitizers
  for (std::uint64_t n = 0; n < frames; ++n) {
    answers[0].frame = n;
    answers[0].gate = n % 100 == 0 ? Gate::match : Gate::new_place;
    answers[0].match = Match{.place = static_cast<std::size_t>(n / 2)};
    processed.report.newest = n;
    processed.report.gate = answers[0].gate;
    summary.add(processed, {});
    watch->publish(processed, {}, summary, {static_cast<std::size_t>(n), 0}, 10ms * n);
    if (n % 200 == 0) std::this_thread::sleep_for(1ms);
    if (n == frames / 2) before = resident_memory();
  }
  [[maybe_unused]] const std::uint64_t after = resident_memory();
  over = true;
  for (std::thread& client : clients) client.join();
  follower.join();
  const std::size_t open = descriptors();
  EXPECT_LT(open, 100U);
  EXPECT_EQ(site.get("/api/marks", "").status, 200);
  server.reset();
  EXPECT_LE(descriptors(), open);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(after, before + 24U * 1024U * 1024U) << "pictures are thinned out at 48 MB, and the "
                                                    "threads' heaps breathe";
#endif
  EXPECT_EQ(summary.frames(), frames);
}

}  // namespace
}  // namespace seqloop::program
