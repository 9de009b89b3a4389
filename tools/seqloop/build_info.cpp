#include "seqloop/build_info.hpp"

#include <fmt/format.h>

#include <fstream>
#include <thread>

#include "seqloop_commit.hpp"

namespace seqloop::program {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string version_line() { return "seqloop " SEQLOOP_VERSION " (" SEQLOOP_COMMIT ")"; }

std::string condition_line() {
  return fmt::format("{}, {} cores; compiler {}; {}", processor(),
                     std::thread::hardware_concurrency(), __VERSION__, version_line());
}

}  // namespace seqloop::program
