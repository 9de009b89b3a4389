// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "seqloop/linux/camera_mode.hpp"
#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// How a driver lays out the pictures that it delivers.
struct PictureFormat {
  std::uint32_t fourcc = 0;
  int width = 0;               ///< pixels
  int height = 0;              ///< pixels
  std::size_t stride = 0;      ///< bytes from row to row, as the driver says
  std::size_t size_bytes = 0;  ///< of a whole picture, as the driver says

  bool operator==(const PictureFormat&) const = default;
};

// Each asks an open camera (G_FMT, TRY_FMT, S_FMT), for either kind of capture, and tells what came
// back. A driver may give another format than the one asked for. EINVAL when it came in several
// planes. @return errno
[[nodiscard]] int read_format(SystemCalls& system, int fd, std::uint32_t type,
                              PictureFormat& given) noexcept;
[[nodiscard]] int try_format(SystemCalls& system, int fd, std::uint32_t type,
                             const CameraMode& mode, PictureFormat& given) noexcept;
[[nodiscard]] int set_format(SystemCalls& system, int fd, std::uint32_t type,
                             const CameraMode& mode, PictureFormat& given) noexcept;

/// Asks for the mode's rate and writes the one that the driver gives into it, 0/0 when it does not
/// say. Errors: none; a camera that knows no rates runs at its own.
void set_rate(SystemCalls& system, int fd, std::uint32_t type, CameraMode& mode) noexcept;

}  // namespace seqloop::live
