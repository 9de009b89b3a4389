// SPDX-License-Identifier: MIT
#include "seqloop/linux/camera.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "linux/capture_start.hpp"
#include "linux/error_text.hpp"
#include "linux/refusal_text.hpp"
#include "linux/time_step.hpp"

namespace seqloop::live {
namespace {

using Milliseconds = std::chrono::milliseconds;

constexpr Nanoseconds short_pause =
    Milliseconds(5);  // where a driver says that there is something, and lies
constexpr Nanoseconds busy_pause = Milliseconds(100);  // until another program is asked for again
constexpr std::uint64_t silences_before_restart = 3;
constexpr std::uint64_t most_silences_between = 96;

// A capture's buffer: which stream, and which slot of it.
constexpr std::uint32_t slots = 64;
constexpr std::uint32_t generations = ~0U / slots + 1;
constexpr std::uint32_t no_buffer = ~0U;

bool is_gone(int error) noexcept { return error == ENODEV || error == ENXIO || error == EBADF; }

}  // namespace

Camera::Camera(CameraOptions options, SystemCalls& system, Clock& clock)
    : options_(std::move(options)), system_(system), clock_(clock) {
  retired_.reserve(most_out);
  open_first();
  twins_ = count_twins(system_, options_.path, facts_.identity);
  silences_to_act_ = silences_before_restart;
  last_frame_ = clock_.now();
}

void Camera::open_first() {
  const Nanoseconds patience = clock_.now() + options_.busy_wait;
  while (true) {
    auto started = start_capture(system_, options_.path, options_.wish, options_.buffers, most_out);
    if (auto* const stream = std::get_if<std::unique_ptr<CaptureStream>>(&started)) {
      return take_up(std::move(*stream));
    }
    const Refusal& refusal = std::get<Refusal>(started);
    if (refusal.why != Refused::busy || clock_.now() >= patience) {
      throw SetupError(explain(system_, options_.path, refusal));
    }
    clock_.sleep_until(clock_.now() + busy_pause);
  }
}

void Camera::take_up(std::unique_ptr<CaptureStream> stream) {
  const VideoNode& node = stream->node();
  facts_ = {node.path, node.identity, stream->mode(), stream->buffers(), stream->copies()};
  numbers_.restart();
  generation_ = (generation_ + 1) % generations;
  stream_ = std::move(stream);
}

/// @return whether the camera is there again
bool Camera::reopen() noexcept {
  next_attempt_ = clock_.now() + options_.retry_interval;
  try {
    const CameraFacts before = facts_;
    const std::string path = find_camera(system_, options_.path, before.identity, twins_);
    if (path.empty()) {
      loss_.assign({before.identity.card, " is not there"});
      return false;
    }
    auto started = start_capture(system_, path, options_.wish, options_.buffers, most_out);
    if (const auto* const refusal = std::get_if<Refusal>(&started)) {
      loss_.assign({path, ": ", brief(*refusal)});
      return false;
    }
    take_up(std::move(std::get<std::unique_ptr<CaptureStream>>(started)));
    ++counters_.reopenings;
    remark_.assign({"opened anew after: ", loss_.view()});
    if (facts_.path != before.path) remark_.append("; found as " + facts_.path);
    if (facts_.identity != before.identity) {
      remark_.append("; it is " + facts_.identity.card + " on " + facts_.identity.bus);
    }
    if (facts_.mode != before.mode) remark_.append("; now " + to_string(facts_.mode));
    return true;
  } catch (...) {  // memory is short: try again later
    loss_.assign({"there is not enough memory to open it"});
    return false;
  }
}

/// Gives the device free; what is out stays readable.
void Camera::retire() noexcept {
  stream_->retire();
  // Every retired stream has a frame out, of which there are at most as many as have room here.
  if (stream_->out() > 0 && retired_.size() < retired_.capacity()) {
    retired_.push_back({generation_, std::move(stream_)});
  }
  stream_.reset();
}

void Camera::lose(std::string_view why) noexcept {
  loss_.assign({why});
  retire();
  lost_since_ = clock_.now();
  loss_untold_ = true;
  // At once, unless that did not help just before.
  next_attempt_ = lost_since_ + (troubles_ <= 2 ? Nanoseconds(0) : options_.retry_interval);
}

void Camera::restart_or_lose(std::string_view why) noexcept {
  const int error = stream_->restart();
  if (error == 0) {
    ++counters_.restarts;
    numbers_.restart();
    remark_.assign({"the stream was started anew after: ", why});
  } else if (error == ESTALE) {
    lose("the camera changed its format");
  } else {
    lose(why);
  }
}

void Camera::trouble(std::string_view doing, int error) noexcept {
  FixedText why;
  why.assign({doing, ": ", error_text(error)});
  ++troubles_;
  if (is_gone(error) || troubles_ > 1) {
    lose(why.view());
  } else {
    restart_or_lose(why.view());
  }
}

void Camera::pause(Nanoseconds until) noexcept {
  clock_.sleep_until(std::min(until, clock_.now() + time_step));
}

void Camera::next(Captured& captured, const std::atomic<bool>& stop) noexcept {
  captured = {};
  captured.buffer = no_buffer;
  const Nanoseconds deadline = clock_.now() + options_.timeout;
  while (!stop.load()) {
    const Nanoseconds now = clock_.now();
    if (stream_) {
      if (now >= deadline) return tell_silent(captured);
      if (capture(captured, deadline)) return;
    } else if (now >= next_attempt_) {
      (void)reopen();
    } else if (loss_untold_ || now >= deadline) {
      return tell_lost(captured, now);
    } else {
      pause(std::min(deadline, next_attempt_));
    }
  }
}

/// Waits for a time step. @return whether `captured` is to be handed over
bool Camera::capture(Captured& captured, Nanoseconds deadline) noexcept {
  if (const int error = stream_->queue_idle(); error != 0 && error != EINTR && error != EAGAIN) {
    trouble("lending a buffer", error);
    return false;
  }
  const Nanoseconds left = std::min(deadline - clock_.now(), time_step);
  const auto milliseconds = std::chrono::ceil<Milliseconds>(left).count();
  const SystemCalls::Polled polled =
      stream_->wait(static_cast<int>(std::max<std::int64_t>(milliseconds, 1)));
  if (polled.error != 0) {
    pause(clock_.now() + short_pause);
    if (polled.error != EINTR && polled.error != EAGAIN) trouble("waiting", polled.error);
    return false;
  }
  if ((polled.events & POLLNVAL) != 0) {
    trouble("waiting", EBADF);
    return false;
  }
  if ((polled.events & POLLPRI) != 0 && stream_->source_changed()) {
    ++troubles_;
    lose("the picture that comes in is another one now");
    return false;
  }
  if ((polled.events & (POLLIN | POLLERR | POLLHUP)) != 0) {
    const bool broken = (polled.events & (POLLERR | POLLHUP)) != 0;
    return take_frame(captured, broken);
  }
  if (polled.events != 0) pause(clock_.now() + short_pause);
  return false;
}

/// @param broken the wait said that something is wrong: if nothing comes, the stream is
bool Camera::take_frame(Captured& captured, bool broken) noexcept {
  const Dequeued taken = stream_->dequeue();
  if (taken.error == EAGAIN || taken.error == EINTR) {
    pause(clock_.now() + short_pause);
    if (broken) trouble("waiting", EIO);
    return false;
  }
  if (taken.error != 0) {
    trouble("taking a frame", taken.error);
    return false;
  }
  fill(captured, taken);
  if (taken.other_format && stream_->format_changed()) {
    ++troubles_;
    lose("the camera changed its format");
  } else if (captured.arrived - last_frame_ >=
             static_cast<std::int64_t>(silences_ + 1) * options_.timeout) {
    act_on_silence("only damaged frames come");
  }
  return true;
}

void Camera::fill(Captured& captured, const Dequeued& taken) noexcept {
  captured.arrived = clock_.now();
  captured.sequence = taken.sequence;
  captured.delivered = counters_.frames + counters_.bad;
  const FrameStamps::Judged judged = stamps_.judge(taken.stamp, taken.monotonic, captured.arrived);
  if (numbers_.starts_anew()) numbers_.lose(frames_between(last_stamp_, judged.stamp));
  captured.index = numbers_.index_of(taken.sequence);
  captured.stamp = last_stamp_ = judged.stamp;
  if (first_stamp_ < Nanoseconds(0)) first_stamp_ = judged.stamp;
  captured.time_s = std::chrono::duration<double>(judged.stamp - first_stamp_).count();
  if (judged.tell) remark(to_string(judged.odd));
  if (!taken.fault.empty()) {
    ++counters_.bad;
    captured.what = Capture::bad_frame;
    captured.fault.assign({taken.fault});
    return;
  }
  ++counters_.frames;
  last_frame_ = captured.arrived;
  troubles_ = 0;
  silences_ = 0;
  silences_to_act_ = silences_before_restart;
  captured.what = Capture::frame;
  const CameraMode& mode = stream_->mode();
  captured.picture = {taken.bytes, mode.width, mode.height, stream_->stride(), mode.format};
  captured.buffer = generation_ * slots + taken.slot;
  captured.remark = std::exchange(remark_, {});
}

/// @return how many frames fit between two, at the camera's rate
std::uint64_t Camera::frames_between(Nanoseconds before, Nanoseconds after) const noexcept {
  const double told = rate(stream_->mode());
  const double intervals = std::chrono::duration<double>(after - before).count() *
                           (told > 0.0 ? told : options_.wish.rate);
  return intervals < 1.5 ? 0 : static_cast<std::uint64_t>(intervals - 0.5);
}

void Camera::remark(std::string_view text) noexcept {
  if (!remark_.empty()) remark_.append("; ");
  remark_.append(text);
}

void Camera::tell_silent(Captured& captured) noexcept {
  ++counters_.silences;
  const Nanoseconds silent = clock_.now() - last_frame_;
  captured.what = Capture::silent;
  captured.fault.assign({"no frame from ", facts_.path, " for "});
  captured.fault.append_number(static_cast<std::uint64_t>(silent / Milliseconds(1)));
  captured.fault.append(" ms");
  act_on_silence(captured.fault.view());
}

/// Another time-out has gone by without a good frame.
void Camera::act_on_silence(std::string_view why) noexcept {
  if (++silences_ < silences_to_act_) return;
  const bool first = silences_to_act_ == silences_before_restart;
  silences_to_act_ += std::min(silences_to_act_, most_silences_between);
  if (first) {
    restart_or_lose(why);
  } else {
    lose(why);
  }
}

void Camera::tell_lost(Captured& captured, Nanoseconds now) noexcept {
  if (std::exchange(loss_untold_, false)) ++counters_.losses;
  captured.what = Capture::lost;
  captured.fault.assign({loss_.view(), "; looked for since "});
  captured.fault.append_number(static_cast<std::uint64_t>((now - lost_since_) / Milliseconds(1)));
  captured.fault.append(" ms");
}

void Camera::give_back(const Captured& captured) noexcept {
  if (captured.buffer == no_buffer) return;
  const std::uint32_t slot = captured.buffer % slots;
  const std::uint32_t generation = captured.buffer / slots;
  if (stream_ && generation == generation_) return stream_->give_back(slot);
  const auto owner = std::ranges::find(retired_, generation, &Retired::generation);
  if (owner == retired_.end()) return;
  owner->stream->give_back(slot);
  if (owner->stream->out() == 0) retired_.erase(owner);
}

CameraCounters Camera::counters() const noexcept {
  CameraCounters counters = counters_;
  counters.missed = numbers_.missed();
  for (std::size_t kind = 0; kind < odd_stamp_kinds; ++kind) {
    counters.odd_stamps[kind] = stamps_.count(static_cast<OddStamp>(kind));
  }
  return counters;
}

}  // namespace seqloop::live
