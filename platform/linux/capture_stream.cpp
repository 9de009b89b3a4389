// SPDX-License-Identifier: MIT
#include "seqloop/linux/detail/capture_stream.hpp"

#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::live {
namespace {

/// The kernel's description of one buffer, for either kind of capture.
struct Buffer {
  v4l2_buffer buffer{};
  v4l2_plane plane{};

  Buffer(std::uint32_t type, std::uint32_t index) noexcept {
    buffer.type = type;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (!planar()) return;
    buffer.m.planes = &plane;
    buffer.length = 1;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  Buffer(Buffer&&) = delete;
  Buffer& operator=(Buffer&&) = delete;
  ~Buffer() = default;

  [[nodiscard]] bool planar() const noexcept {
    return buffer.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  }
  [[nodiscard]] std::size_t length() const noexcept {
    return planar() ? plane.length : buffer.length;
  }
  [[nodiscard]] std::int64_t offset() const noexcept {
    return planar() ? plane.m.mem_offset : buffer.m.offset;
  }
  [[nodiscard]] std::size_t used() const noexcept {
    return planar() ? plane.bytesused : buffer.bytesused;
  }
  [[nodiscard]] std::size_t data_offset() const noexcept {
    return planar() ? plane.data_offset : 0;
  }
};

}  // namespace

CaptureStream::CaptureStream(SystemCalls& system, VideoNode node) noexcept
    : system_(system), node_(std::move(node)) {}

CaptureStream::~CaptureStream() { (void)stop(); }

int CaptureStream::set_mode(const CameraMode& wanted) noexcept {
  const int fd = node_.fd.get();
  PictureFormat given;
  if (const int error = set_format(system_, fd, node_.buffer_type, wanted, given); error != 0) {
    return error;
  }
  const auto format = readable(given.fourcc);
  if (!format || given.width <= 0 || given.height <= 0) return EINVAL;
  given_ = given;
  mode_ = wanted;
  mode_.fourcc = given.fourcc;
  mode_.format = *format;
  mode_.width = given.width;
  mode_.height = given.height;
  stride_ =
      *format == RawFormat::mjpg ? 0 : std::max(given.stride, row_bytes(*format, given.width));
  set_rate(system_, fd, node_.buffer_type, mode_);
  // Drivers that do not know events refuse, and are looked at in other ways.
  v4l2_event_subscription event{};
  event.type = V4L2_EVENT_SOURCE_CHANGE;
  (void)system_.ioctl(fd, VIDIOC_SUBSCRIBE_EVENT, &event);
  return 0;
}

int CaptureStream::allocate(std::uint32_t count, std::uint32_t most_out) {
  v4l2_requestbuffers request{};
  request.count = std::min(count, most_buffers);
  request.type = node_.buffer_type;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = system_.ioctl(node_.fd.get(), VIDIOC_REQBUFS, &request); error != 0) {
    return error;
  }
  if (request.count < 2) return ENOBUFS;
  const std::uint32_t granted = std::min(request.count, most_buffers);
  mappings_.reserve(granted);
  for (std::uint32_t index = 0; index < granted; ++index) {
    if (const int error = map_buffer(index); error != 0) return error;
  }
  // With one to fill and one to be filled next, while the others are out.
  if (granted >= most_out + 2) return 0;
  copies_.resize(most_out);
  for (Copy& copy : copies_) copy.bytes.resize(mappings_.front().bytes().size());
  return 0;
}

int CaptureStream::map_buffer(std::uint32_t index) {
  Buffer asked(node_.buffer_type, index);
  if (const int error = system_.ioctl(node_.fd.get(), VIDIOC_QUERYBUF, &asked.buffer); error != 0) {
    return error;
  }
  if (asked.length() < least_bytes(mode_.format, stride_, mode_.width, mode_.height)) return EINVAL;
  const SystemCalls::Mapped mapped = system_.map(node_.fd.get(), asked.length(), asked.offset());
  if (mapped.error != 0) return mapped.error;
  mappings_.emplace_back(system_, mapped.address, asked.length());
  return 0;
}

int CaptureStream::queue(std::uint32_t index) noexcept {
  Buffer buffer(node_.buffer_type, index);
  const int error = system_.ioctl(node_.fd.get(), VIDIOC_QBUF, &buffer.buffer);
  states_[index] = error == 0 ? State::queued : State::idle;
  return error;
}

int CaptureStream::queue_idle() noexcept {
  for (std::uint32_t index = 0; index < mappings_.size(); ++index) {
    if (states_[index] != State::idle) continue;
    if (const int error = queue(index); error != 0) return error;
  }
  return 0;
}

int CaptureStream::start() noexcept {
  if (const int error = queue_idle(); error != 0) return error;
  int type = static_cast<int>(node_.buffer_type);
  const int error = system_.ioctl(node_.fd.get(), VIDIOC_STREAMON, &type);
  on_ = error == 0;
  return error;
}

int CaptureStream::stop() noexcept {
  if (!on_) return 0;
  int type = static_cast<int>(node_.buffer_type);
  if (const int error = system_.ioctl(node_.fd.get(), VIDIOC_STREAMOFF, &type); error != 0) {
    return error;
  }
  on_ = false;
  for (State& state : states_) {
    if (state == State::queued) state = State::idle;
  }
  return 0;
}

int CaptureStream::restart() noexcept {
  if (const int error = stop(); error != 0) return error;
  return format_changed() ? ESTALE : start();
}

bool CaptureStream::format_changed() noexcept {
  PictureFormat now;
  return read_format(system_, node_.fd.get(), node_.buffer_type, now) == 0 && now != given_;
}

SystemCalls::Polled CaptureStream::wait(int milliseconds) noexcept {
  constexpr short events = POLLIN | POLLPRI;
  return system_.poll(node_.fd.get(), events, milliseconds);
}

bool CaptureStream::source_changed() noexcept {
  v4l2_event event{};
  return system_.ioctl(node_.fd.get(), VIDIOC_DQEVENT, &event) == 0 &&
         event.type == V4L2_EVENT_SOURCE_CHANGE &&
         (event.u.src_change.changes & V4L2_EVENT_SRC_CH_RESOLUTION) != 0;
}

Dequeued CaptureStream::dequeue() noexcept {
  Dequeued taken;
  Buffer buffer(node_.buffer_type, 0);
  taken.error = system_.ioctl(node_.fd.get(), VIDIOC_DQBUF, &buffer.buffer);
  if (taken.error != 0) return taken;
  const v4l2_buffer& filled = buffer.buffer;
  taken.sequence = filled.sequence;
  // What is centuries ahead is odd enough without its exact value, which nanoseconds cannot hold.
  constexpr std::int64_t most_seconds = 9'000'000'000;
  taken.stamp =
      std::chrono::seconds(
          std::clamp<std::int64_t>(filled.timestamp.tv_sec, -most_seconds, most_seconds)) +
      std::chrono::microseconds(std::clamp<std::int64_t>(filled.timestamp.tv_usec, 0, 999'999));
  taken.monotonic =
      (filled.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const std::uint32_t index = filled.index;
  if (index >= mappings_.size() || states_[index] != State::queued) {
    taken.fault = "the driver handed over a buffer that it did not have";
    return taken;
  }
  states_[index] = State::idle;
  const std::span<const std::uint8_t> memory = mappings_[index].bytes();
  const std::size_t begin = std::min(buffer.data_offset(), memory.size());
  const std::size_t used = buffer.used() - std::min(buffer.used(), buffer.data_offset());
  judge(memory.subspan(begin), used, (filled.flags & V4L2_BUF_FLAG_ERROR) != 0, taken);
  if (taken.fault.empty()) lend(index, taken);
  return taken;
}

void CaptureStream::judge(std::span<const std::uint8_t> memory, std::size_t used, bool damaged,
                          Dequeued& taken) const noexcept {
  const std::size_t least = least_bytes(mode_.format, stride_, mode_.width, mode_.height);
  if (damaged) {
    taken.fault = "the camera says that the frame is damaged";
  } else if (used == 0) {
    taken.fault = "the frame is empty";
  } else if (used > memory.size()) {
    taken.fault = "the frame claims more bytes than its memory has";
  } else if (used < least) {
    taken.fault = "the frame has too few bytes";
  }
  taken.other_format = !damaged && used != 0 && !taken.fault.empty();
  // Decoders want the padding of the last row too, which some drivers do not count.
  const std::size_t whole = bytes_of(mode_.format, stride_, mode_.height);
  taken.bytes = memory.first(std::min(std::max(used, whole), memory.size()));
}

void CaptureStream::lend(std::uint32_t index, Dequeued& taken) noexcept {
  if (copies_.empty()) {
    states_[index] = State::out;
    taken.slot = index;
    ++out_;
    return;
  }
  const auto free = std::ranges::find(copies_, false, &Copy::out);
  if (free == copies_.end()) {
    taken.fault = "more frames are held than may be";
    return;
  }
  const std::size_t size = std::min(taken.bytes.size(), free->bytes.size());
  std::copy_n(taken.bytes.begin(), size, free->bytes.begin());
  taken.bytes = std::span<const std::uint8_t>(free->bytes).first(size);
  taken.slot = most_buffers + static_cast<std::uint32_t>(free - copies_.begin());
  free->out = true;
  ++out_;
}

void CaptureStream::give_back(std::uint32_t slot) noexcept {
  if (slot >= most_buffers) {
    const std::size_t copy = slot - most_buffers;
    if (copy >= copies_.size() || !copies_[copy].out) return;
    copies_[copy].out = false;
    --out_;
    return;
  }
  if (slot >= mappings_.size() || states_[slot] != State::out) return;
  states_[slot] = State::idle;
  --out_;
}

void CaptureStream::retire() noexcept {
  (void)stop();
  for (std::uint32_t index = 0; index < mappings_.size(); ++index) {
    if (states_[index] != State::out) mappings_[index].reset();
  }
  // A mapping keeps the device open, and its buffers would keep it busy; this takes them from it
  // (since Linux 4.20 even while one is mapped).
  v4l2_requestbuffers none{};
  none.type = node_.buffer_type;
  none.memory = V4L2_MEMORY_MMAP;
  (void)system_.ioctl(node_.fd.get(), VIDIOC_REQBUFS, &none);
  node_.fd.reset();
  on_ = false;
}

}  // namespace seqloop::live
