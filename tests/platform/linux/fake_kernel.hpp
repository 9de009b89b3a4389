// SPDX-License-Identifier: MIT
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/clock.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live::test {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using std::chrono_literals::operator""s;

/// Time that passes only when somebody waits, and a little with every call.
class FakeClock : public Clock {
 public:
  Nanoseconds now() noexcept override { return now_; }
  void sleep_until(Nanoseconds moment) noexcept override { now_ = std::max(now_, moment); }
  void advance(Nanoseconds by) noexcept { now_ += by; }

 private:
  Nanoseconds now_ = 1000s;
};

/// Calls in which faults can be injected.
enum class Call : std::size_t {
  open,
  query_capability,
  list_formats,
  list_sizes,
  list_rates,
  set_format,
  get_format,
  try_format,
  set_rate,
  get_rate,
  subscribe,
  request_buffers,
  query_buffer,
  map,
  queue,
  stream_on,
  stream_off,
  dequeue,
  dequeue_event,
  query_control,
  read_control,
  query_menu,
  poll
};
inline constexpr std::size_t calls = 23;

/// A camera in memory that does what videobuf2 does.
struct FakeCamera {
  struct Offered {
    std::uint32_t fourcc;
    std::uint32_t width;
    std::uint32_t height;
    std::vector<std::uint32_t> rates;
  };
  struct Buffer {
    std::shared_ptr<std::vector<std::uint8_t>> memory;
    bool queued = false;
    v4l2_buffer filled{};
  };

  std::string driver = "uvcvideo";
  std::string card = "Eye";
  std::string bus = "usb-1";
  std::string serial = "1";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<Offered> offered = {{V4L2_PIX_FMT_YUYV, 64, 48, {5, 10, 30}},
                                  {V4L2_PIX_FMT_YUYV, 32, 24, {10, 30}},
                                  {V4L2_PIX_FMT_MJPEG, 128, 96, {30}}};
  std::optional<v4l2_frmsize_stepwise> size_range;
  std::optional<v4l2_frmival_stepwise> rate_range;
  bool lists_sizes = true;
  std::uint32_t row_padding = 0;
  std::uint32_t most_buffers = 32;
  bool orphans = true;  ///< REQBUFS(0) works while buffers are mapped
  bool tells_events = true;
  std::uint32_t first_sequence = 0;
  std::uint32_t stamp_flag = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  bool silent = false;
  std::vector<v4l2_query_ext_ctrl> controls;  ///< by rising id
  std::function<void(v4l2_buffer&)> edit;     ///< what a dequeued buffer says

  // State.
  bool present = true;
  int owner = -1;
  Offered mode{};
  std::uint32_t rate = 10;
  std::vector<Buffer> buffers;
  std::vector<std::uint32_t> done;  ///< the oldest first
  bool streaming = false;
  std::uint32_t sequence = 0;
  Nanoseconds next_frame{0};
  int events = 0;
  std::uint64_t made = 0;  ///< frames, taken or not

  [[nodiscard]] bool planar() const { return (capabilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0; }
};

/// Stands in for the kernel: cameras, faults at any call, and an account of what is open.
class FakeKernel : public SystemCalls {
 public:
  explicit FakeKernel(FakeClock& clock) : clock_(clock) {}

  /// Plugs a camera in.
  FakeCamera& plug(const std::string& path, FakeCamera camera = {});
  /// Pulls it out: its node goes, what is open gets ENODEV.
  std::shared_ptr<FakeCamera> pull(const std::string& path);
  void replug(const std::string& path, std::shared_ptr<FakeCamera> camera);
  [[nodiscard]] FakeCamera& at(const std::string& path) { return *nodes_.at(path); }
  void link(const std::string& from, const std::string& to) { links_[from] = to; }

  /// Asked at every call for an errno. @param nth of this kind of call, from 0
  std::function<int(Call call, std::uint64_t nth)> fault;
  std::map<std::string, FileFacts> files;    ///< what is no camera
  std::map<std::string, std::string> texts;  ///< small files
  std::map<std::string, std::vector<std::string>> folders;

  [[nodiscard]] std::size_t open_files() const { return files_open_.size(); }
  [[nodiscard]] std::size_t mapped() const { return mappings_.size(); }
  [[nodiscard]] std::uint64_t wrong() const { return wrong_; }  ///< double closes and the like
  [[nodiscard]] std::uint64_t total_calls() const { return total_; }
  [[nodiscard]] std::uint64_t count(Call call) const {
    return counts_[static_cast<std::size_t>(call)];
  }

  Opened open(const char* path) noexcept override;
  int close(int fd) noexcept override;
  int ioctl(int fd, unsigned long request, void* argument) noexcept override;
  Mapped map(int fd, std::size_t length, std::int64_t offset) noexcept override;
  int unmap(void* address, std::size_t length) noexcept override;
  Polled poll(int fd, short events, int milliseconds) noexcept override;
  std::vector<std::string> list_folder(const std::string& path) override;
  std::string read_text(const std::string& path) override;
  std::string resolve(const std::string& path) override;
  FileFacts facts(const std::string& path) override;

 private:
  struct File {
    std::shared_ptr<FakeCamera> camera;
  };
  struct Map {
    int fd;
    std::shared_ptr<FakeCamera> camera;
    std::shared_ptr<std::vector<std::uint8_t>> memory;
  };

  int enter(Call call);
  void run(FakeCamera& camera);
  void make_frame(FakeCamera& camera);
  void leave(FakeCamera& camera, int fd);
  int answer(FakeCamera& camera, int fd, unsigned long request, void* argument);
  static int enumerate_format(FakeCamera& camera, v4l2_fmtdesc& asked);
  static int enumerate_size(FakeCamera& camera, v4l2_frmsizeenum& asked);
  static int enumerate_rate(FakeCamera& camera, v4l2_frmivalenum& asked);
  int set_format(FakeCamera& camera, v4l2_format& format, bool keep);
  static void tell_format(const FakeCamera& camera, const FakeCamera::Offered& mode,
                          v4l2_format& format);
  static int answer_control(const FakeCamera& camera, unsigned long request, void* argument);
  int request_buffers(FakeCamera& camera, int fd, v4l2_requestbuffers& asked);
  int dequeue(FakeCamera& camera, v4l2_buffer& asked);
  static FakeCamera::Offered fitted(const FakeCamera& camera, std::uint32_t fourcc,
                                    std::uint32_t width, std::uint32_t height);

  FakeClock& clock_;
  std::map<std::string, std::shared_ptr<FakeCamera>> nodes_;
  std::map<std::string, std::string> links_;
  std::map<int, File> files_open_;
  std::map<void*, Map> mappings_;
  std::array<std::uint64_t, calls> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t wrong_ = 0;
  int next_fd_ = 3;
};

}  // namespace seqloop::live::test
