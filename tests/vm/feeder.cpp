// SPDX-License-Identifier: MIT
// v4l2-feeder: plays a folder of JPEG files into a v4l2loopback device, as a camera that sends MJPG
// or YUYV would, with faults on demand. For the virtual machine's tests.
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"

namespace {

using seqloop::Image;
using seqloop::RawFormat;
using seqloop::turbojpeg::JpegFileDecoder;

using Bytes = std::vector<std::uint8_t>;

struct Settings {
  std::string device;
  std::string folder;
  bool yuyv = false;
  double fps = 10.0;
  std::uint64_t first = 0;   ///< picture to start with
  std::uint64_t frames = 0;  ///< to send; 0: all pictures once
  std::string wait_for;      ///< file that says when to start; the format is set before
  std::uint64_t truncate_every = 0;
  std::uint64_t corrupt_every = 0;
  std::uint64_t stop_at = 0;  ///< frame before which nothing comes for a while
  double stop_s = 0.0;
};

struct Pictures {
  std::vector<Bytes> frames;
  int width = 0;
  int height = 0;
};

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

Bytes read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Studio range of ITU-R 601, the colour of two neighbours from the left one.
/// @param picture B, G, R
Bytes to_yuyv(const Image& picture) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  Bytes bytes;
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* const row = picture.data + static_cast<std::size_t>(y) * picture.stride;
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* const left = row + 3 * (x / 2 * 2);
      const std::uint8_t* const here = row + 3 * x;
      bytes.push_back(byte(16.0 + 0.098 * here[0] + 0.504 * here[1] + 0.257 * here[2]));
      const double colour = x % 2 == 0 ? 0.439 * left[0] - 0.291 * left[1] - 0.148 * left[2]
                                       : -0.071 * left[0] - 0.368 * left[1] + 0.439 * left[2];
      bytes.push_back(byte(128.0 + colour));
    }
  }
  return bytes;
}

/// All pictures in memory, so that sending them takes no time.
Pictures load(const Settings& settings) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(settings.folder)) {
    if (entry.path().extension() == ".jpg") paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  if (settings.first >= paths.size()) throw std::runtime_error("too few .jpg files in the folder");
  const auto first = static_cast<std::size_t>(settings.first);
  const std::uint64_t last = settings.frames == 0
                                 ? paths.size()
                                 : std::min<std::uint64_t>(paths.size(), first + settings.frames);
  Pictures pictures;
  JpegFileDecoder decoder(false);
  for (std::size_t at = first; at < last; ++at) {
    pictures.frames.push_back(read_file(paths[at]));
    Bytes& file = pictures.frames.back();
    if (at > first && !settings.yuyv) continue;
    Image picture;
    const auto fault = decoder.decode({.bytes = file, .format = RawFormat::mjpg}, picture);
    if (!fault.empty()) throw std::runtime_error(paths[at].string() + ": " + std::string(fault));
    if (at == first) pictures.width = picture.width, pictures.height = picture.height;
    if (settings.yuyv) file = to_yuyv(picture);
  }
  return pictures;
}

/// Opens the device and makes it a camera, without a frame yet.
int open_device(const Settings& settings, const Pictures& pictures) {
  const int device = open(settings.device.c_str(), O_RDWR | O_CLOEXEC);
  if (device < 0) fail(settings.device);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  auto& pixels = format.fmt.pix;
  pixels.width = static_cast<std::uint32_t>(pictures.width);
  pixels.height = static_cast<std::uint32_t>(pictures.height);
  pixels.pixelformat = settings.yuyv ? V4L2_PIX_FMT_YUYV : V4L2_PIX_FMT_MJPEG;
  pixels.field = V4L2_FIELD_NONE;
  const v4l2_pix_format asked = pixels;
  if (ioctl(device, VIDIOC_S_FMT, &format) != 0) fail("VIDIOC_S_FMT");
  // With a reader there the driver keeps the format before.
  if (pixels.pixelformat != asked.pixelformat || pixels.width != asked.width ||
      pixels.height != asked.height) {
    throw std::runtime_error("the device keeps another format");
  }
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  if (ioctl(device, VIDIOC_STREAMON, &type) != 0) fail("VIDIOC_STREAMON");
  return device;
}

bool is_every(std::uint64_t frame, std::uint64_t every) {
  return every > 0 && frame % every == every - 1;
}

void send(int device, const Settings& settings, std::uint64_t frame, Bytes bytes) {
  if (is_every(frame, settings.truncate_every)) bytes.resize(bytes.size() / 2);
  if (is_every(frame, settings.corrupt_every)) {
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 64, 0xff);
  }
  if (write(device, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    fail("write of frame " + std::to_string(frame));
  }
}

void play(const Settings& settings) {
  const Pictures pictures = load(settings);
  const int device = open_device(settings, pictures);
  std::puts("ready");
  std::fflush(stdout);
  while (!settings.wait_for.empty() && !std::filesystem::exists(settings.wait_for)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const std::uint64_t frames = settings.frames == 0 ? pictures.frames.size() : settings.frames;
  const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(1.0 / settings.fps));
  auto due = std::chrono::steady_clock::now();
  for (std::uint64_t frame = 0; frame < frames; ++frame, due += period) {
    if (settings.stop_s > 0.0 && frame == settings.stop_at) {
      due += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::duration<double>(settings.stop_s));
    }
    std::this_thread::sleep_until(due);
    send(device, settings, frame,
         pictures.frames[static_cast<std::size_t>(frame % pictures.frames.size())]);
  }
  close(device);
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Plays JPEG files into a v4l2loopback device"};
  app.add_option("--device", settings.device)->required();
  app.add_option("--folder", settings.folder)->required();
  app.add_flag("--yuyv", settings.yuyv, "decoded; without it MJPG, the files as they are");
  app.add_option("--fps", settings.fps)->check(CLI::PositiveNumber);
  app.add_option("--first", settings.first, "picture to start with");
  app.add_option("--frames", settings.frames, "to send, starting anew after the last picture");
  app.add_option("--wait-for", settings.wait_for, "file that says when to start");
  app.add_option("--truncate-every", settings.truncate_every, "every k-th frame is cut in half");
  app.add_option("--corrupt-every", settings.corrupt_every, "every k-th frame has 64 bytes of ff");
  app.add_option("--stop-at", settings.stop_at, "frame before which nothing comes for --stop-s");
  app.add_option("--stop-s", settings.stop_s, "seconds");
  CLI11_PARSE(app, argc, argv);
  try {
    play(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "v4l2-feeder: %s\n", error.what());
    return 1;
  }
  return 0;
}
