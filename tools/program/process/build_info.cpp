// SPDX-License-Identifier: MIT
#include "program/process/build_info.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <thread>

#include "seqloop/detail/counted.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop_commit.hpp"

namespace seqloop::program {
namespace {

/// A board's name, or the processor's: ARM kernels name no processor.
std::string processor() {
  std::string board;
  if (std::getline(std::ifstream("/proc/device-tree/model"), board, '\0')) return board;
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string version_line() { return "seqloop " SEQLOOP_VERSION " (" SEQLOOP_COMMIT ")"; }

std::string program_state() {
  std::string version = version_line();
  const bool exact =
      version.find("dirty") == std::string::npos && version.find("unknown") == std::string::npos;
  if (exact) return version;
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto written = std::filesystem::last_write_time(self, error).time_since_epoch().count();
  return fmt::format("{} {}", version, written);
}

std::string condition_line() {
  return fmt::format("{}, {}, kernels {}; compiler {}; OpenCV " CV_VERSION "; {}", processor(),
                     counted(std::thread::hardware_concurrency(), "core"),
                     best_integer_kernels().name, __VERSION__, version_line());
}

}  // namespace seqloop::program
