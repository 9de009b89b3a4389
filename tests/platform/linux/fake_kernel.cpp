// SPDX-License-Identifier: MIT
#include "platform/linux/fake_kernel.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "seqloop/linux/pixel_format.hpp"

namespace seqloop::live::test {
namespace {

constexpr Nanoseconds call_time = 10us;
constexpr Nanoseconds exposure = 8ms;

template <std::size_t size>
void put(__u8 (&into)[size], const std::string& text) {
  std::memset(into, 0, size);
  std::memcpy(into, text.data(), std::min(text.size(), size - 1));
}

std::uint32_t stride_of(const FakeCamera& camera, const FakeCamera::Offered& mode) {
  const auto format = readable(mode.fourcc);
  if (!format || *format == RawFormat::mjpg) return 0;
  return static_cast<std::uint32_t>(row_bytes(*format, static_cast<int>(mode.width))) +
         camera.row_padding;
}

std::uint32_t size_of(const FakeCamera& camera, const FakeCamera::Offered& mode) {
  const auto format = readable(mode.fourcc);
  if (!format || *format == RawFormat::mjpg) return mode.width * mode.height;
  return static_cast<std::uint32_t>(
      bytes_of(*format, stride_of(camera, mode), static_cast<int>(mode.height)));
}

Call call_of(unsigned long request) {
  static const std::map<unsigned long, Call> known = {
      {VIDIOC_QUERYCAP, Call::query_capability},
      {VIDIOC_ENUM_FMT, Call::list_formats},
      {VIDIOC_ENUM_FRAMESIZES, Call::list_sizes},
      {VIDIOC_ENUM_FRAMEINTERVALS, Call::list_rates},
      {VIDIOC_S_FMT, Call::set_format},
      {VIDIOC_G_FMT, Call::get_format},
      {VIDIOC_TRY_FMT, Call::try_format},
      {VIDIOC_S_PARM, Call::set_rate},
      {VIDIOC_G_PARM, Call::get_rate},
      {VIDIOC_SUBSCRIBE_EVENT, Call::subscribe},
      {VIDIOC_REQBUFS, Call::request_buffers},
      {VIDIOC_QUERYBUF, Call::query_buffer},
      {VIDIOC_QBUF, Call::queue},
      {VIDIOC_STREAMON, Call::stream_on},
      {VIDIOC_STREAMOFF, Call::stream_off},
      {VIDIOC_DQBUF, Call::dequeue},
      {VIDIOC_DQEVENT, Call::dequeue_event},
      {VIDIOC_QUERY_EXT_CTRL, Call::query_control},
      {VIDIOC_G_EXT_CTRLS, Call::read_control},
      {VIDIOC_QUERYMENU, Call::query_menu}};
  return known.at(request);
}

template <class T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

FakeCamera& FakeKernel::plug(const std::string& path, FakeCamera camera) {
  replug(path, std::make_shared<FakeCamera>(std::move(camera)));
  return at(path);
}

void FakeKernel::replug(const std::string& path, std::shared_ptr<FakeCamera> camera) {
  camera->present = true;
  const std::string sysfs = "/sys/class/video4linux/" + path.substr(path.rfind('/') + 1);
  texts[sysfs + "/device/../serial"] = camera->serial;
  texts[sysfs + "/index"] = "0";
  nodes_[path] = std::move(camera);
}

std::shared_ptr<FakeCamera> FakeKernel::pull(const std::string& path) {
  auto camera = nodes_.at(path);
  nodes_.erase(path);
  camera->present = false;
  camera->streaming = false;
  // What comes back is a new device to the kernel.
  auto back = std::make_shared<FakeCamera>(*camera);
  back->owner = -1;
  back->buffers.clear();
  back->done.clear();
  return back;
}

int FakeKernel::enter(Call call) {
  const auto kind = static_cast<std::size_t>(call);
  ++total_;
  clock_.advance(call_time);
  const std::uint64_t nth = counts_[kind]++;
  return fault ? fault(call, nth) : 0;
}

SystemCalls::Opened FakeKernel::open(const char* path) noexcept {
  if (const int error = enter(Call::open); error != 0) return {-1, error};
  const auto node = nodes_.find(resolve(path));
  if (node == nodes_.end()) return {-1, ENOENT};
  const int fd = next_fd_++;
  files_open_[fd] = {node->second};
  return {fd, 0};
}

int FakeKernel::close(int fd) noexcept {
  const auto file = files_open_.find(fd);
  if (file == files_open_.end()) {
    ++wrong_;
    return EBADF;
  }
  const std::shared_ptr<FakeCamera> camera = file->second.camera;
  files_open_.erase(file);
  leave(*camera, fd);
  return 0;
}

/// A file lives as long as it is open or mapped, and owns the buffers until then.
void FakeKernel::leave(FakeCamera& camera, int fd) {
  if (camera.owner != fd || files_open_.contains(fd)) return;
  for (const auto& [address, map] : mappings_) {
    if (map.fd == fd) return;
  }
  camera.owner = -1;
  camera.buffers.clear();
  camera.done.clear();
  camera.streaming = false;
}

SystemCalls::Mapped FakeKernel::map(int fd, std::size_t length, std::int64_t offset) noexcept {
  if (const int error = enter(Call::map); error != 0) return {nullptr, error};
  const auto& camera = files_open_.at(fd).camera;
  const auto index = static_cast<std::size_t>(offset / 4096);
  if (index >= camera->buffers.size()) return {nullptr, EINVAL};
  const auto& memory = camera->buffers[index].memory;
  if (memory->size() != length) return {nullptr, EINVAL};
  mappings_[memory->data()] = {fd, camera, memory};
  return {memory->data(), 0};
}

int FakeKernel::unmap(void* address, std::size_t length) noexcept {
  const auto found = mappings_.find(address);
  if (found == mappings_.end() || found->second.memory->size() != length) {
    ++wrong_;
    return EINVAL;
  }
  const Map map = found->second;
  mappings_.erase(found);
  std::ranges::fill(*map.memory, std::uint8_t{0xDD});  // whoever still reads it sees that
  leave(*map.camera, map.fd);
  return 0;
}

void FakeKernel::make_frame(FakeCamera& camera) {
  ++camera.made;
  const std::uint32_t sequence = camera.sequence++;
  const auto free = std::ranges::find(camera.buffers, true, &FakeCamera::Buffer::queued);
  if (free == camera.buffers.end()) return;  // lost
  free->queued = false;
  std::ranges::fill(*free->memory, static_cast<std::uint8_t>(camera.made));
  v4l2_buffer& filled = free->filled;
  filled = {};
  filled.index = static_cast<std::uint32_t>(free - camera.buffers.begin());
  filled.sequence = sequence;
  filled.flags = camera.stamp_flag;
  filled.bytesused = static_cast<std::uint32_t>(free->memory->size());
  const Nanoseconds stamp = camera.next_frame - exposure;
  filled.timestamp.tv_sec = std::chrono::duration_cast<std::chrono::seconds>(stamp).count();
  filled.timestamp.tv_usec =
      std::chrono::duration_cast<std::chrono::microseconds>(stamp % 1s).count();
  camera.done.push_back(filled.index);
}

void FakeKernel::run(FakeCamera& camera) {
  while (camera.streaming && !camera.silent && camera.next_frame <= clock_.now()) {
    make_frame(camera);
    camera.next_frame += Nanoseconds(1s) / camera.rate;
  }
  if (camera.silent) camera.next_frame = clock_.now();
}

SystemCalls::Polled FakeKernel::poll(int fd, short events, int milliseconds) noexcept {
  if (const int error = enter(Call::poll); error != 0) return {0, error};
  if (!files_open_.contains(fd)) {
    ++wrong_;
    return {POLLNVAL, 0};
  }
  FakeCamera& camera = *files_open_.at(fd).camera;
  if (!camera.present) return {POLLERR | POLLHUP, 0};
  if (!camera.streaming) return {POLLERR, 0};
  run(camera);
  const Nanoseconds end = clock_.now() + std::chrono::milliseconds(milliseconds);
  while (camera.done.empty() && camera.events == 0 && !camera.silent && camera.next_frame <= end) {
    clock_.sleep_until(camera.next_frame);
    run(camera);
  }
  short ready = 0;
  if (!camera.done.empty()) ready = static_cast<short>(ready | POLLIN);
  if (camera.events > 0) ready = static_cast<short>(ready | POLLPRI);
  if (ready == 0) clock_.sleep_until(end);
  return {static_cast<short>(ready & events), 0};
}

int FakeKernel::ioctl(int fd, unsigned long request, void* argument) noexcept {
  if (const int error = enter(call_of(request)); error != 0) return error;
  const auto file = files_open_.find(fd);
  if (file == files_open_.end()) {
    ++wrong_;
    return EBADF;
  }
  FakeCamera& camera = *file->second.camera;
  if (!camera.present) return ENODEV;
  run(camera);
  return answer(camera, fd, request, argument);
}

int FakeKernel::answer(FakeCamera& camera, int fd, unsigned long request, void* argument) {
  const bool owner = camera.owner == -1 || camera.owner == fd;
  switch (call_of(request)) {
    case Call::query_capability: {
      auto& told = as<v4l2_capability>(argument);
      put(told.driver, camera.driver);
      put(told.card, camera.card);
      put(told.bus_info, camera.bus);
      told.capabilities = camera.capabilities | V4L2_CAP_DEVICE_CAPS;
      told.device_caps = camera.capabilities;
      return 0;
    }
    case Call::list_formats:
      return enumerate_format(camera, as<v4l2_fmtdesc>(argument));
    case Call::list_sizes:
      return enumerate_size(camera, as<v4l2_frmsizeenum>(argument));
    case Call::list_rates:
      return enumerate_rate(camera, as<v4l2_frmivalenum>(argument));
    case Call::set_format:
      if (!owner || !camera.buffers.empty()) return EBUSY;
      return set_format(camera, as<v4l2_format>(argument), true);
    case Call::try_format:
      return set_format(camera, as<v4l2_format>(argument), false);
    case Call::get_format:
      tell_format(camera, camera.mode, as<v4l2_format>(argument));
      return 0;
    case Call::set_rate:
    case Call::get_rate: {
      v4l2_captureparm& told = as<v4l2_streamparm>(argument).parm.capture;
      if (call_of(request) == Call::set_rate && told.timeperframe.numerator != 0) {
        camera.rate = told.timeperframe.denominator / told.timeperframe.numerator;
      }
      told.capability = V4L2_CAP_TIMEPERFRAME;
      told.timeperframe = {1, camera.rate};
      return 0;
    }
    case Call::subscribe:
      return camera.tells_events ? 0 : ENOTTY;
    case Call::request_buffers:
      return owner ? request_buffers(camera, fd, as<v4l2_requestbuffers>(argument)) : EBUSY;
    case Call::query_buffer: {
      auto& told = as<v4l2_buffer>(argument);
      if (told.index >= camera.buffers.size()) return EINVAL;
      const auto length = static_cast<std::uint32_t>(camera.buffers[told.index].memory->size());
      if (camera.planar()) {
        told.m.planes->length = length;
        told.m.planes->m.mem_offset = told.index * 4096;
      } else {
        told.length = length;
        told.m.offset = told.index * 4096;
      }
      return 0;
    }
    case Call::queue: {
      const std::uint32_t index = as<v4l2_buffer>(argument).index;
      if (index >= camera.buffers.size() || camera.buffers[index].queued) {
        ++wrong_;
        return EINVAL;
      }
      camera.buffers[index].queued = true;
      return 0;
    }
    case Call::stream_on:
      camera.streaming = true;
      camera.sequence = camera.first_sequence;
      camera.next_frame = clock_.now() + Nanoseconds(1s) / camera.rate;
      return 0;
    case Call::stream_off:
      camera.streaming = false;
      camera.done.clear();
      for (FakeCamera::Buffer& buffer : camera.buffers) buffer.queued = false;
      return 0;
    case Call::dequeue:
      return dequeue(camera, as<v4l2_buffer>(argument));
    case Call::dequeue_event: {
      if (camera.events == 0) return ENOENT;
      --camera.events;
      auto& told = as<v4l2_event>(argument);
      told.type = V4L2_EVENT_SOURCE_CHANGE;
      told.u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
      return 0;
    }
    default:
      return answer_control(camera, request, argument);
  }
}

/// A control's value is one above its default; a menu has its even items.
int FakeKernel::answer_control(const FakeCamera& camera, unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYMENU) {
    auto& told = as<v4l2_querymenu>(argument);
    if (told.index % 2 != 0) return EINVAL;
    std::memcpy(&told.name, "even", sizeof "even");  // packed: no reference to it
    return 0;
  }
  const bool value = request == VIDIOC_G_EXT_CTRLS;
  const std::uint32_t id =
      value ? as<v4l2_ext_controls>(argument).controls->id : as<v4l2_query_ext_ctrl>(argument).id;
  const std::uint32_t last = id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  for (const v4l2_query_ext_ctrl& control : camera.controls) {
    if (value && control.id == id) {
      as<v4l2_ext_controls>(argument).controls->value =
          static_cast<std::int32_t>(control.default_value) + 1;
      return 0;
    }
    if (!value && control.id > last) {
      as<v4l2_query_ext_ctrl>(argument) = control;
      return 0;
    }
  }
  return EINVAL;
}

int FakeKernel::dequeue(FakeCamera& camera, v4l2_buffer& asked) {
  if (!camera.streaming) return EINVAL;
  if (camera.done.empty()) return EAGAIN;
  v4l2_buffer filled = camera.buffers[camera.done.front()].filled;
  camera.done.erase(camera.done.begin());
  if (camera.edit) camera.edit(filled);
  if (camera.planar()) {
    asked.m.planes->bytesused = filled.bytesused;
    filled.m.planes = asked.m.planes;
    filled.length = 1;
  }
  asked = filled;
  return 0;
}

int FakeKernel::enumerate_format(FakeCamera& camera, v4l2_fmtdesc& asked) {
  std::vector<std::uint32_t> formats;
  for (const auto& mode : camera.offered) {
    if (std::ranges::find(formats, mode.fourcc) == formats.end()) formats.push_back(mode.fourcc);
  }
  if (asked.index >= formats.size()) return EINVAL;
  asked.pixelformat = formats[asked.index];
  put(asked.description, "a format");
  return 0;
}

int FakeKernel::enumerate_size(FakeCamera& camera, v4l2_frmsizeenum& asked) {
  if (!camera.lists_sizes) return ENOTTY;
  if (camera.size_range) {
    if (asked.index > 0) return EINVAL;
    asked.type = V4L2_FRMSIZE_TYPE_STEPWISE;
    asked.stepwise = *camera.size_range;
    return 0;
  }
  std::uint32_t index = 0;
  for (const auto& mode : camera.offered) {
    if (mode.fourcc != asked.pixel_format || index++ != asked.index) continue;
    asked.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    asked.discrete = {mode.width, mode.height};
    return 0;
  }
  return EINVAL;
}

int FakeKernel::enumerate_rate(FakeCamera& camera, v4l2_frmivalenum& asked) {
  if (camera.rate_range) {
    if (asked.index > 0) return EINVAL;
    asked.type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
    asked.stepwise = *camera.rate_range;
    return 0;
  }
  const FakeCamera::Offered mode = fitted(camera, asked.pixel_format, asked.width, asked.height);
  if (asked.index >= mode.rates.size()) return EINVAL;
  asked.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  asked.discrete = {1, mode.rates[asked.index]};
  return 0;
}

/// What a driver makes of a wish: the mode itself, else the first of that format, else the first.
FakeCamera::Offered FakeKernel::fitted(const FakeCamera& camera, std::uint32_t fourcc,
                                       std::uint32_t width, std::uint32_t height) {
  FakeCamera::Offered best = camera.offered.empty() ? FakeCamera::Offered{} : camera.offered[0];
  bool same_format = false;
  for (const auto& mode : camera.offered) {
    if (mode.fourcc != fourcc) continue;
    if (camera.size_range || (mode.width == width && mode.height == height)) {
      best = mode;
      best.width = width;
      best.height = height;
      return best;
    }
    if (!same_format) best = mode;
    same_format = true;
  }
  return best;
}

int FakeKernel::set_format(FakeCamera& camera, v4l2_format& format, bool keep) {
  const FakeCamera::Offered mode =
      camera.planar()
          ? fitted(camera, format.fmt.pix_mp.pixelformat, format.fmt.pix_mp.width,
                   format.fmt.pix_mp.height)
          : fitted(camera, format.fmt.pix.pixelformat, format.fmt.pix.width, format.fmt.pix.height);
  if (mode.fourcc == 0) return EINVAL;
  tell_format(camera, mode, format);
  if (keep) camera.mode = mode;
  return 0;
}

void FakeKernel::tell_format(const FakeCamera& camera, const FakeCamera::Offered& mode,
                             v4l2_format& format) {
  if (camera.planar()) {
    v4l2_pix_format_mplane& told = format.fmt.pix_mp;
    told.pixelformat = mode.fourcc;
    told.width = mode.width;
    told.height = mode.height;
    told.num_planes = 1;
    told.plane_fmt[0].bytesperline = stride_of(camera, mode);
    told.plane_fmt[0].sizeimage = size_of(camera, mode);
    return;
  }
  v4l2_pix_format& told = format.fmt.pix;
  told.pixelformat = mode.fourcc;
  told.width = mode.width;
  told.height = mode.height;
  told.bytesperline = stride_of(camera, mode);
  told.sizeimage = size_of(camera, mode);
}

int FakeKernel::request_buffers(FakeCamera& camera, int fd, v4l2_requestbuffers& asked) {
  bool mapped = false;
  for (const auto& [address, map] : mappings_) mapped = mapped || map.camera.get() == &camera;
  if (mapped && !camera.orphans) return EBUSY;
  camera.buffers.clear();
  camera.done.clear();
  camera.streaming = false;
  asked.count = std::min(asked.count, camera.most_buffers);
  camera.owner = asked.count == 0 ? -1 : fd;
  camera.done.reserve(asked.count);
  for (std::uint32_t i = 0; i < asked.count; ++i) {
    camera.buffers.push_back(
        {std::make_shared<std::vector<std::uint8_t>>(size_of(camera, camera.mode)), false, {}});
  }
  return 0;
}

std::vector<std::string> FakeKernel::list_folder(const std::string& path) {
  if (path != "/dev") return folders.contains(path) ? folders[path] : std::vector<std::string>();
  std::vector<std::string> names = {".", "..", "null", "video", "videotape"};
  for (const auto& [node, camera] : nodes_) names.push_back(node.substr(5));
  return names;
}

std::string FakeKernel::read_text(const std::string& path) {
  return texts.contains(path) ? texts[path] : std::string();
}

std::string FakeKernel::resolve(const std::string& path) {
  if (links_.contains(path)) {
    return nodes_.contains(links_[path]) || !path.starts_with("/dev") ? links_[path]
                                                                      : std::string();
  }
  return nodes_.contains(path) || files.contains(path) ? path : std::string();
}

FileFacts FakeKernel::facts(const std::string& path) {
  if (nodes_.contains(resolve(path))) return {FileKind::video_device, 0, "video"};
  if (files.contains(path)) return files[path];
  return {FileKind::missing, ENOENT, {}};
}

}  // namespace seqloop::live::test
