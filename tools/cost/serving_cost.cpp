// SPDX-License-Identifier: MIT
#include "cost/serving_cost.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "cost/instruction_counter.hpp"
#include "cost/synthetic_picture.hpp"
#include "cost/web_client.hpp"
#include "program/watch/serving.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"

namespace seqloop::cost {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr std::uint16_t served_port = 8321;
constexpr std::uint64_t frames_a_second = 30;
constexpr std::uint64_t seconds = 20;
constexpr std::uint64_t seconds_to_begin = 5;  // connections come up, pages ask for the first time

/// A run that recognises every frame.
class ShownLoop {
 public:
  explicit ShownLoop(program::Watch& watch)
      : watch_(&watch),
        summary_(Budget{}, true),
        jpeg_(synthetic_jpeg()),
        decoder_(opencv::make_builtin_describer()->needs()) {
    const RawPicture raw{jpeg_, synthetic_width, synthetic_height, 0, RawFormat::mjpg};
    const std::string_view fault = decoder_.decode(raw, picture_);
    if (!fault.empty()) throw std::runtime_error(std::string(fault));
  }

  /// Before a frame is handed over: what does not belong to that.
  void prepare() {
    answers_[0].frame = number_;
    answers_[0].gate = Gate::match;
    answers_[0].probability = 0.995F;
    answers_[0].match = Match{static_cast<std::size_t>(number_), 0.5F, 0.7F, 1.0,
                              static_cast<std::size_t>(number_ + 10)};
    processed_.report.newest = number_;
    processed_.report.gate = Gate::match;
    processed_.report.answers = answers_;
    processed_.frame.image = picture_;
    processed_.frame.time_s = static_cast<double>(number_) / frames_a_second;
    processed_.times.grab = 1ms;
    processed_.times.describe = 2ms;
    processed_.times.match = 400us + 10us * (number_ % 7);
    processed_.times.total = 3500us;
    summary_.add(processed_, {});
    ++number_;
  }

  void publish() noexcept {
    watch_->publish(processed_, {}, summary_, {3476, 0}, 1s * number_ / frames_a_second);
  }

 private:
  program::Watch* watch_;
  program::RunSummary summary_;
  std::vector<std::uint8_t> jpeg_;
  turbojpeg::MjpgDecoder decoder_;
  Image picture_;
  std::uint64_t number_ = 0;
  std::array<Answer, 1> answers_;
  ProcessedFrame processed_;
};

/// Instructions of all threads but this one.
class OtherThreads {
 public:
  explicit OtherThreads(Where where) : all_(Whose::threads, where), own_(Whose::thread, where) {}

  [[nodiscard]] std::uint64_t executed() const { return all_.executed() - own_.executed(); }

 private:
  InstructionCounter all_;
  InstructionCounter own_;
};

}  // namespace

ServingCost count_serving(std::size_t clients) {
  WebClients crowd(clients, served_port);
  const InstructionCounter own;
  const OtherThreads server(Where::program);
  const OtherThreads server_and_kernel(Where::program_and_kernel);
  program::ServeSettings settings;
  settings.address = "127.0.0.1:" + std::to_string(served_port);
  program::Serving serving(settings, {{"source", "/dev/video0"}, {"method", "o-seqcnnslam"}}, false,
                           nullptr);
  ShownLoop loop(serving.watch());

  ServingCost cost;
  auto next = steady_clock::now();
  for (std::uint64_t second = 0; second < seconds_to_begin + seconds; ++second) {
    const std::uint64_t served_before = server.executed();
    const std::uint64_t kernel_before = server_and_kernel.executed();
    const std::uint64_t bytes_before = crowd.bytes();
    std::uint64_t published = 0;
    for (std::uint64_t frame = 0; frame < frames_a_second; ++frame) {
      loop.prepare();
      published += own.count([&] { loop.publish(); });
      next += std::chrono::nanoseconds(1s) / frames_a_second;
      std::this_thread::sleep_until(next);
    }
    if (second < seconds_to_begin) continue;
    cost.publish += published;
    cost.serve += server.executed() - served_before;
    cost.with_kernel += server_and_kernel.executed() - kernel_before;
    cost.bytes += crowd.bytes() - bytes_before;
  }
  for (std::uint64_t* of_all : {&cost.publish, &cost.serve, &cost.with_kernel, &cost.bytes}) {
    *of_all /= seconds * frames_a_second;
  }
  return cost;
}

}  // namespace seqloop::cost
