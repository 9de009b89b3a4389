// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "seqloop/clock.hpp"
#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/detail/mapping.hpp"
#include "seqloop/linux/detail/picture_format.hpp"
#include "seqloop/linux/detail/video_node.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// What the driver handed over.
struct Dequeued {
  static constexpr std::uint32_t no_slot = 63;

  int error = 0;  ///< errno; EAGAIN: there is nothing yet. Then nothing else means anything
  std::uint32_t slot = no_slot;         ///< to give back; no_slot: there is nothing to
  std::span<const std::uint8_t> bytes;  ///< of a good frame
  std::string_view fault;               ///< of a bad frame: why, static text
  std::uint32_t sequence = 0;
  Nanoseconds stamp{0};
  bool monotonic = false;     ///< the stamp is on the clock that this program reads
  bool other_format = false;  ///< the frame has not the bytes that the format wants
};

/// A camera that streams into mapped memory, in the kernel's own verbs and their order:
///
///     set_mode → allocate → start → ( queue_idle → wait → dequeue → give_back )* → retire
///
/// Calls return errno, 0 being none. After an error, `restart` may help; what does not help ends
/// with the object, which leaves nothing open or mapped behind. Where the driver lends so few
/// buffers that a reader could stop the camera, each picture is copied.
class CaptureStream {
 public:
  CaptureStream(SystemCalls& system, VideoNode node) noexcept;
  CaptureStream(const CaptureStream&) = delete;
  CaptureStream& operator=(const CaptureStream&) = delete;
  CaptureStream(CaptureStream&&) = delete;
  CaptureStream& operator=(CaptureStream&&) = delete;
  ~CaptureStream();

  /// Sets format, size and rate. What the driver made of them is `mode()`.
  [[nodiscard]] int set_mode(const CameraMode& wanted) noexcept;

  /// Borrows and maps buffers. ENOBUFS: the driver lends less than two. Allocates: yes.
  /// @param count asked for, up to `most_buffers`
  /// @param most_out pictures that may be out at a time
  [[nodiscard]] int allocate(std::uint32_t count, std::uint32_t most_out);

  /// Queues all buffers that are not out, and lets the camera run.
  [[nodiscard]] int start() noexcept;

  /// Waits until there is something to dequeue. @param milliseconds at most
  [[nodiscard]] SystemCalls::Polled wait(int milliseconds) noexcept;

  /// Takes the oldest picture. Allocates: never.
  [[nodiscard]] Dequeued dequeue() noexcept;

  /// Takes an event. @return whether it says that the picture coming in is another one now
  [[nodiscard]] bool source_changed() noexcept;

  /// This memory may be filled again. What is not out is not touched.
  void give_back(std::uint32_t slot) noexcept;

  /// Queues what is neither queued nor out: what was given back, and bad frames.
  [[nodiscard]] int queue_idle() noexcept;

  /// Stops and starts again, with the same memory; what is out stays out. ESTALE: the driver has
  /// another format now.
  [[nodiscard]] int restart() noexcept;

  /// Whether the driver's format is another one than was set. Where it does not say: no.
  [[nodiscard]] bool format_changed() noexcept;

  /// Leaves the device to others at once; only what is out stays mapped. Nothing but `give_back`
  /// and `out` may be called from then on.
  void retire() noexcept;

  /// Pictures that are not given back.
  [[nodiscard]] std::uint32_t out() const noexcept { return out_; }

  [[nodiscard]] const CameraMode& mode() const noexcept { return mode_; }
  [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
  [[nodiscard]] const VideoNode& node() const noexcept { return node_; }
  [[nodiscard]] std::size_t buffers() const noexcept { return mappings_.size(); }
  [[nodiscard]] bool copies() const noexcept { return !copies_.empty(); }

  static constexpr std::uint32_t most_buffers = 32;

 private:
  enum class State : std::uint8_t { idle, queued, out };
  struct Copy {
    std::vector<std::uint8_t> bytes;
    bool out = false;
  };

  [[nodiscard]] int map_buffer(std::uint32_t index);
  [[nodiscard]] int queue(std::uint32_t index) noexcept;
  [[nodiscard]] int stop() noexcept;
  void judge(std::span<const std::uint8_t> memory, std::size_t used, bool damaged,
             Dequeued& taken) const noexcept;
  void lend(std::uint32_t index, Dequeued& taken) noexcept;

  SystemCalls& system_;
  VideoNode node_;
  CameraMode mode_;
  PictureFormat given_;
  std::size_t stride_ = 0;
  std::vector<Mapping> mappings_;
  std::vector<Copy> copies_;
  std::array<State, most_buffers> states_{};
  std::uint32_t out_ = 0;
  bool on_ = false;
};

}  // namespace seqloop::live
