// SPDX-License-Identifier: MIT
#include "program/process/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "program/process/say.hpp"

namespace seqloop::program {
namespace {

constexpr std::string_view clear_line = "\r\033[K";

}  // namespace

Progress::Progress(std::string doing, std::optional<std::uint64_t> frames)
    : doing_(std::move(doing)), frames_(frames), shown_(isatty(STDERR_FILENO) == 1) {}

void Progress::step(std::uint64_t frames) {
  done_ += frames;
  if (!shown_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  draw();
}

void Progress::tell(std::string_view message) {
  if (shown_) say_raw(clear_line);
  say("{}", message);
}

void Progress::tell_fault(std::string_view name, std::uint64_t index, std::string_view fault) {
  alike_ = fault == fault_ && index == fault_index_ + 1 ? alike_ + 1 : 0;
  fault_ = fault;
  fault_index_ = index;
  if (alike_ == 0) tell(fmt::format("{}: {}", name, fault));
  if (alike_ == 1)
    tell(fmt::format("{}: the same; what follows and is the same, too, is not told", name));
}

void Progress::done() {
  if (shown_) say_raw(clear_line);
}

void Progress::draw() const {
  constexpr std::uint64_t width = 30;
  const std::chrono::duration<double> passed = drawn_ - start_;
  const double rate = static_cast<double>(done_) / std::max(passed.count(), 1e-9);
  if (!frames_ || *frames_ == 0) {
    say_raw(fmt::format("{}{} frame {}, {:.0f} frames/s", clear_line, doing_, done_, rate));
    return;
  }
  const std::uint64_t filled = std::min(width, done_ * width / *frames_);
  const double left = static_cast<double>(*frames_ - std::min(*frames_, done_)) / rate;
  say_raw(fmt::format("{}{} [{:#<{}}{:.<{}}] {}/{}, {:.0f} frames/s, {:.0f} s left", clear_line,
                      doing_, "", filled, "", width - filled, done_, *frames_, rate, left));
}

}  // namespace seqloop::program
