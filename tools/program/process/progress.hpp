// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace seqloop::program {

/// A line on stderr that says how far the work is, where somebody can see it; else nothing.
class Progress {
 public:
  Progress(std::string doing, std::optional<std::uint64_t> frames);

  /// Draws nothing; `tell` still tells.
  Progress() = default;

  /// @param frames that are done since the last call
  void step(std::uint64_t frames = 1);

  /// Prints a line of its own, as `seqloop: MESSAGE`, terminal or not.
  void tell(std::string_view message);

  /// Clears the line.
  void done();

 private:
  void draw() const;

  std::string doing_;
  std::optional<std::uint64_t> frames_;
  bool shown_ = false;
  std::uint64_t done_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point drawn_ = start_;
};

}  // namespace seqloop::program
