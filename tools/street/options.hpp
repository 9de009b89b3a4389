// SPDX-License-Identifier: MIT
// What the user asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "output.hpp"

namespace seqloop::street {

enum class Drives { localise, loop };

struct Options {
  static constexpr std::size_t kMostFrames = 1'000'000;
  static constexpr int kLeastPixels = 16, kMostPixels = 4096;

  std::string out;
  std::size_t frames = 300;  ///< of each drive, 1..kMostFrames
  std::uint64_t seed = 1;
  std::string drives = "localise";  ///< localise or loop
  std::string size = "320x180";     ///< WIDTHxHEIGHT, each kLeastPixels..kMostPixels
  std::string format = "jpg";       ///< jpg, png or avi
  double length = 0.0;              ///< metres a drive; 0 is one for each frame
  std::size_t kidnaps = 0;          ///< in loop drives
  std::string first_light = "summer";
  std::string second_light;  ///< empty: winter to localise, evening to loop
  bool keep = false, quiet = false;
};

/// Options as the program needs them, all known to be good.
struct Job {
  Drives drives{};
  Format format{};
  int width{}, height{};
  std::size_t frames{}, kidnaps{};
  std::uint64_t seed{};
  double length{};  ///< metres
  Light first, second;
  std::string parameters;  ///< all that the frames depend on, one a line
};

/// @param faults takes a line "WHAT: WHY" for every fault. @return nothing if there is any.
std::optional<Job> check(const Options& options, std::vector<std::string>& faults);

/// The plan of the reference drive (`again` false) or of the query drive over the same street.
DrivePlan localise_plan(const Job& job, bool again);
/// The plan of the drive that closes loops.
DrivePlan loop_plan(const Job& job);

}  // namespace seqloop::street
