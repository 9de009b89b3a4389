// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "seqloop/linux/system_calls.hpp"

namespace seqloop::live {

/// A knob of a camera: exposure, gain, focus ...
struct CameraControl {
  std::string name;
  std::string type;  ///< int, bool, menu ... as the kernel's tools name it
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::int64_t step = 0;
  std::int64_t preset = 0;  ///< its value by default
  std::int64_t value = 0;
  bool readable = false;           ///< whether `value` means anything
  std::vector<std::string> items;  ///< of a menu, `3: Aperture Priority Mode`
};

/// All controls that can be set by a number. Errors: a list that breaks off is taken as far as it
/// goes. Allocates: yes.
[[nodiscard]] std::vector<CameraControl> read_controls(SystemCalls& system, int fd);

}  // namespace seqloop::live
