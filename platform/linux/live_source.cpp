// SPDX-License-Identifier: MIT
#include "seqloop/linux/live_source.hpp"

#include <array>
#include <system_error>
#include <utility>

#include "linux/time_step.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::live {
namespace {

bool is_frame(const Captured& captured) noexcept {
  return captured.what == Capture::frame || captured.what == Capture::bad_frame;
}

}  // namespace

LiveSource::LiveSource(std::unique_ptr<CaptureDevice> device,
                       std::unique_ptr<PictureDecoder> decoder, Clock& clock, LiveSettings settings)
    : device_(std::move(device)),
      decoder_(std::move(decoder)),
      clock_(&clock),
      settings_(std::move(settings)) {
  try {
    thread_ = std::thread(&LiveSource::capture, this);
  } catch (const std::system_error& error) {
    throw SetupError({"capture thread", error.what(),
                      "raise the limits on threads (`ulimit -u`) and locked memory (`ulimit -l`)"});
  }
  started_.wait();
  if (start_fault_ == nullptr) return;
  thread_.join();
  std::rethrow_exception(start_fault_);
}

LiveSource::~LiveSource() { stop(); }

void LiveSource::stop() noexcept {
  if (!thread_.joinable()) return;
  stopping_.store(true);
  thread_.join();
  finish_with_last();
  take_back_finished();
  for (Captured& captured : frames_.slots()) give_back(captured);
}

void LiveSource::capture() noexcept {
  try {
    if (settings_.at_start) settings_.at_start();
  } catch (...) {
    start_fault_ = std::current_exception();
  }
  const bool failed = start_fault_ != nullptr;
  started_.count_down();
  if (failed) return;
  do {
    // Before the device is asked, so that what the reader finishes with meanwhile is not out beside
    // another one: one frame is read, one waits, and one is being brought.
    take_back_finished();
    doing_.store(Doing::asking_for_a_frame, std::memory_order_relaxed);
    device_->next(frames_.writing(), stopping_);
    rounds_.fetch_add(1, std::memory_order_relaxed);
    doing_.store(Doing::giving_back, std::memory_order_relaxed);
  } while (pass_on(frames_.writing()) && !stopping_.load(std::memory_order_relaxed));
}

bool LiveSource::pass_on(Captured& captured) noexcept {
  if (captured.what == Capture::nothing) return true;
  if (!is_frame(captured)) {
    pass_on_event(captured);
    return captured.what != Capture::end;
  }
  delivered_.store(captured.delivered + 1, std::memory_order_relaxed);
  lost_.store(captured.index - captured.delivered, std::memory_order_relaxed);
  const std::uint32_t every = every_.load(std::memory_order_relaxed);
  if (captured.index < take_from_ && every > 1) {
    drop(captured);
    return true;
  }
  take_from_ = captured.index - captured.index % every + every;
  if (!untold_.empty()) {
    if (!captured.remark.empty()) untold_.append("; ");
    untold_.append(captured.remark.view());
    captured.remark = std::exchange(untold_, {});
  }
  Captured& before = frames_.publish();
  wake_up_.call();
  drop(before);
  return true;
}

/// Gives a frame back that nobody has taken. What was odd about it is told with the next one.
void LiveSource::drop(Captured& captured) noexcept {
  if (is_frame(captured) && !captured.remark.empty()) {
    if (!untold_.empty()) untold_.append("; ");
    untold_.append(captured.remark.view());
  }
  give_back(captured);
}

void LiveSource::pass_on_event(const Captured& captured) noexcept {
  if (captured.what != Capture::end) {
    silences_.fetch_add(1, std::memory_order_relaxed);
  } else if (captured.index > captured.delivered) {
    // No frame comes any more that would tell of those lost after the last one.
    lost_.store(captured.index - captured.delivered, std::memory_order_relaxed);
  }
  Captured& event = events_.writing();
  event = captured;
  event.delivered = delivered_.load(std::memory_order_relaxed);
  events_.publish();
  wake_up_.call();
}

void LiveSource::give_back(Captured& captured) noexcept {
  if (is_frame(captured)) device_->give_back(captured);
  captured.what = Capture::nothing;
}

void LiveSource::take_back_finished() noexcept {
  while (const Captured* finished = finished_.front()) {
    device_->give_back(*finished);
    finished_.pop();
  }
}

void LiveSource::finish_with_last() noexcept {
  Captured& last = frames_.reading();
  if (is_frame(last) && finished_.push(last)) last.what = Capture::nothing;
}

Grab LiveSource::grab(Frame& frame) noexcept {
  frame = {};
  if (!thread_.joinable()) return Grab::end;
  finish_with_last();
  const Nanoseconds began = clock_->now();
  Nanoseconds alive = began;
  std::uint64_t rounds = rounds_.load(std::memory_order_relaxed);
  while (true) {
    // Events first: whatever was published before one is then seen, and goes before it.
    event_waits_ = events_.take() || event_waits_;
    if (frames_.take()) return take_up(frame, began);
    if (event_waits_) {
      const Captured& event = events_.reading();
      if (event.what == Capture::end) return Grab::end;
      event_waits_ = false;
      if (event.delivered >= next_delivered_) {
        frame.fault = event.fault.view();
        frame.waited = clock_->now() - began;
        return Grab::silent;
      }
    }
    if (settings_.stop != nullptr && settings_.stop()) return Grab::end;
    wake_up_.wait(time_step);
    const Nanoseconds now = clock_->now();
    if (const std::uint64_t newest = rounds_.load(std::memory_order_relaxed); newest != rounds) {
      rounds = newest;
      alive = now;
    } else if (now - alive >= settings_.hang_timeout) {
      frame.waited = now - began;
      return tell_hang(frame, now - alive);
    }
  }
}

Grab LiveSource::take_up(Frame& frame, Nanoseconds began) noexcept {
  const Captured& captured = frames_.reading();
  const Nanoseconds now = clock_->now();
  if (taken_ == 0 && settings_.from_first_taken) {
    first_index_ = next_index_ = captured.index;
    first_delivered_ = next_delivered_ = captured.delivered;
    first_time_s_ = captured.time_s;
  }
  frame.index = captured.index - first_index_;
  frame.time_s = captured.time_s - first_time_s_;
  frame.dropped = captured.delivered - next_delivered_;
  frame.lost = captured.index - next_index_ - frame.dropped;
  frame.sequence = captured.sequence;
  frame.age = now - captured.stamp;
  frame.waited = now - began;
  frame.remark = captured.remark.view();
  next_index_ = captured.index + 1;
  next_delivered_ = captured.delivered + 1;
  dropped_ += frame.dropped;
  ++taken_;

  if (captured.what == Capture::bad_frame) {
    frame.fault = captured.fault.view();
  } else if (!captured.descriptor.empty()) {
    frame.descriptor = captured.descriptor;
    return Grab::frame;
  } else if (decoder_ == nullptr) {
    frame.fault = "nothing is there to decode pictures with";
  } else {
    frame.fault = decoder_->decode(captured.picture, frame.image);
    if (frame.fault.empty()) return Grab::frame;
    frame.image = {};
  }
  ++failed_;
  return Grab::unreadable;
}

Grab LiveSource::tell_hang(Frame& frame, Nanoseconds since) noexcept {
  // In the order of `Doing`.
  static constexpr std::array<std::string_view, 2> names = {"asking the device for a frame",
                                                            "giving a frame back to the device"};
  const auto doing = static_cast<std::size_t>(doing_.load(std::memory_order_relaxed));
  hang_.assign({"the capture thread hangs: for "});
  hang_.append_number(static_cast<std::uint64_t>(since / std::chrono::milliseconds(1)));
  hang_.append(" ms it has been ");
  hang_.append(names[doing]);
  frame.fault = hang_.view();
  ++hangs_;
  return Grab::silent;
}

LiveCounts LiveSource::counts() const noexcept {
  LiveCounts counts;
  const bool none_taken = taken_ == 0 && settings_.from_first_taken;
  const std::uint64_t delivered = delivered_.load(std::memory_order_relaxed);
  counts.delivered = none_taken ? 0 : delivered - first_delivered_;
  counts.taken = taken_;
  // After the last frame there is nothing that may yet be taken.
  const bool over = !thread_.joinable() || (event_waits_ && events_.reading().what == Capture::end);
  counts.dropped = over ? counts.delivered - taken_ : dropped_;
  counts.failed = failed_;
  counts.lost =
      none_taken ? 0 : lost_.load(std::memory_order_relaxed) - (first_index_ - first_delivered_);
  counts.silences = silences_.load(std::memory_order_relaxed) + hangs_;
  return counts;
}

}  // namespace seqloop::live
