// SPDX-License-Identifier: MIT
#include "program/watch/serving.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "program/options/verb.hpp"
#include "program/process/say.hpp"
#include "program/watch/background.hpp"
#include "program/watch/run_site.hpp"
#include "seqloop/http/server.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;

std::string new_token() {
  std::array<unsigned char, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    throw SetupError({"serve", "the system gives no random numbers for a token",
                      "give one with --serve-token FILE"});
  }
  std::string token;
  for (const unsigned char byte : random) token += fmt::format("{:02x}", byte);
  return token;
}

std::string read_token(const std::filesystem::path& file) {
  constexpr std::size_t shortest = 16;
  constexpr std::size_t longest = 256;
  std::ifstream stream(file);
  // A file of another kind may have no lines, and no end.
  std::string token(longest + 2, '\0');
  stream.read(token.data(), static_cast<std::streamsize>(token.size()));
  token.resize(static_cast<std::size_t>(stream.gcount()));
  token.resize(std::min(token.find('\n'), token.size()));
  while (!token.empty() && (token.back() == '\r' || token.back() == ' ')) token.pop_back();
  const bool visible = std::ranges::all_of(token, [](char c) { return c > 0x20 && c < 0x7F; });
  if (!stream.is_open() || !visible || token.size() < shortest || token.size() > longest) {
    throw SetupError(
        {"serve-token",
         file.string() + (stream.is_open() ? " holds no token of 16 to 256 visible characters"
                                           : " cannot be read"),
         "make one: openssl rand -hex 16 > " + file.string()});
  }
  return token;
}

http::Address parse(const std::string& text) {
  try {
    return http::parse_address(text);
  } catch (const std::invalid_argument& why) {
    throw SetupError(Fault{"serve", why.what()});
  }
}

}  // namespace

void check(const ServeSettings& settings, Faults& faults) {
  collect(faults, [&] { static_cast<void>(parse(*settings.address)); });
  if (settings.token.empty()) return;
  collect(faults, [&] { static_cast<void>(read_token(settings.token)); });
}

class Serving::Impl {
 public:
  Impl(const ServeSettings& settings, nlohmann::ordered_json run, bool own_places,
       std::unique_ptr<PlacePictures> pictures)
      : token_(settings.token.empty() ? new_token() : read_token(settings.token)),
        site_(watch_, std::move(run), own_places, std::move(pictures)),
        server_(parse(*settings.address), token_, site_) {
    site_.serve_by(server_);
    const std::string url = "http://" + http::to_string(server_.address());
    if (!http::is_loopback(server_.address().host)) {
      say("WARNING: whoever reaches {} over the network sees what the camera sees",
          http::to_string(server_.address()));
    }
    say("serving on {}", url);
    if (settings.token.empty()) say("to control it: {}/#token={}", url, token_);
    thread_ = std::thread([this] { follow(); });
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  Impl(Impl&&) = delete;
  Impl& operator=(Impl&&) = delete;
  ~Impl() {
    {
      const std::scoped_lock lock(mutex_);
      ending_ = true;
    }
    end_.notify_all();
    thread_.join();
  }

  Watch& watch() noexcept { return watch_; }
  RunSite& site() noexcept { return site_; }

 private:
  void follow() {
    become_background();
    std::unique_lock lock(mutex_);
    while (!ending_) {
      lock.unlock();
      site_.follow();
      lock.lock();
      end_.wait_for(lock, 20ms, [this] { return ending_; });
    }
    site_.end();
  }

  Watch watch_;
  std::string token_;
  RunSite site_;
  http::Server server_;
  std::mutex mutex_;
  std::condition_variable end_;
  bool ending_ = false;
  std::thread thread_;
};

Serving::Serving(const ServeSettings& settings, nlohmann::ordered_json run, bool own_places,
                 std::unique_ptr<PlacePictures> pictures)
    : impl_(std::make_unique<Impl>(settings, std::move(run), own_places, std::move(pictures))) {}
Serving::~Serving() = default;

Watch& Serving::watch() noexcept { return impl_->watch(); }
void Serving::keep_in(LastingMap& map) { impl_->site().keep_in(map); }
void Serving::add_place(const Image& image, std::uint64_t number) {
  impl_->site().add_place(image, number);
}

}  // namespace seqloop::program
