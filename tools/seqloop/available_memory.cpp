#include "seqloop/available_memory.hpp"

#include <fstream>
#include <limits>
#include <string>

#include "seqloop/say.hpp"

namespace seqloop::program {

std::size_t available_memory() {
  std::ifstream info("/proc/meminfo");
  std::string name;
  std::size_t kibibytes = 0;
  for (std::string unit; info >> name >> kibibytes; std::getline(info, unit)) {
    if (name == "MemAvailable:") return kibibytes * 1024;
  }
  return std::numeric_limits<std::size_t>::max();
}

bool fits_memory(std::size_t bytes, std::string_view what) {
  constexpr double gigabyte = 1e9;
  const std::size_t available = available_memory();
  if (bytes <= available / 10 * 9) return true;
  say("{}: left out, it takes {:.1f} GB of memory and {:.1f} GB are available", what,
      static_cast<double>(bytes) / gigabyte, static_cast<double>(available) / gigabyte);
  return false;
}

}  // namespace seqloop::program
