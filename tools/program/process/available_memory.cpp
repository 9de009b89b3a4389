// SPDX-License-Identifier: MIT
#include "program/process/available_memory.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <limits>
#include <string>

#include "program/process/say.hpp"

namespace seqloop::program {

std::uint64_t available_memory() {
  // A 32-bit program on a 64-bit kernel reads of more than it can address.
  constexpr std::uint64_t most = std::numeric_limits<std::size_t>::max();
  std::ifstream info("/proc/meminfo");
  std::string name;
  std::uint64_t kibibytes = 0;
  for (std::string unit; info >> name >> kibibytes; std::getline(info, unit)) {
    if (name == "MemAvailable:") return std::min(kibibytes * 1024, most);
  }
  return most;
}

std::uint64_t resident_memory() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t all = 0;
  std::uint64_t resident = 0;
  statm >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

bool fits_memory(std::uint64_t bytes, std::string_view what) {
  constexpr double gigabyte = 1e9;
  const std::uint64_t available = available_memory();
  if (bytes <= available / 10 * 9) return true;
  say("{}: left out, it takes {:.1f} GB of memory and {:.1f} GB are available", what,
      static_cast<double>(bytes) / gigabyte, static_cast<double>(available) / gigabyte);
  return false;
}

}  // namespace seqloop::program
