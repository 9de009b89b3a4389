// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "seqloop/linux/detail/unique_fd.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// By what a camera is known, wherever it turns up.
struct CameraIdentity {
  std::string driver;
  std::string card;    ///< the product's name
  std::string bus;     ///< where it is plugged in
  std::string serial;  ///< of a USB camera; empty where it has none. Cheap ones all have the same
  std::string index;   ///< which of the camera's nodes this is; empty where it is not known

  bool operator==(const CameraIdentity&) const = default;
};

/// Why a camera could not be opened.
enum class Refused : std::uint8_t {
  missing,          ///< nothing is there
  denied,           ///< this user may not
  no_video,         ///< it is something else than a V4L2 device
  no_capture,       ///< a V4L2 device that takes no pictures, or not by streaming
  no_format,        ///< it offers nothing that can be read
  not_offered,      ///< it does not offer what the user insists on
  busy,             ///< somebody else uses it
  too_few_buffers,  ///< it lends less than two
  failed            ///< the call named in `doing` failed
};

struct Refusal {
  Refused why = Refused::failed;
  std::string doing;  ///< the call
  int error = 0;      ///< errno
  FileKind kind = FileKind::video_device;
  std::vector<std::string> offered;  ///< of `no_format` and `not_offered`
};

/// An open V4L2 device that captures.
struct VideoNode {
  UniqueFd fd;
  std::string path;  ///< as it was asked for
  CameraIdentity identity;
  std::uint32_t buffer_type = 0;  ///< single-planar or multi-planar capture
};

/// What a V4L2 device says of itself.
struct NodeFacts {
  CameraIdentity identity;
  std::uint32_t capabilities = 0;
};

/// Asks an open device. @return errno
[[nodiscard]] int read_facts(SystemCalls& system, int fd, const std::string& path,
                             NodeFacts& facts);

/// The type of its buffers; 0 where the device cannot stream pictures into memory.
[[nodiscard]] std::uint32_t capture_type(std::uint32_t capabilities) noexcept;

/// Opens a device, if it is a camera. Allocates: yes.
[[nodiscard]] std::variant<VideoNode, Refusal> open_node(SystemCalls& system,
                                                         const std::string& path);

/// `/dev/video0` and its like, by number.
[[nodiscard]] std::vector<std::string> video_paths(SystemCalls& system);

}  // namespace seqloop::live
