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

  /// Prints what is wrong with a frame. Of frames one after another of which the same is said, a
  /// whole drive perhaps, the first two are named.
  /// @param name what stands in front of the message; @param index of the frame, rising
  void tell_fault(std::string_view name, std::uint64_t index, std::string_view fault);

  /// Clears the line.
  void done();

 private:
  void draw() const;

  std::string doing_;
  std::optional<std::uint64_t> frames_;
  bool shown_ = false;
  std::uint64_t done_ = 0;
  std::string fault_;  // told last
  std::uint64_t fault_index_ = 0;
  std::uint64_t alike_ = 0;  // frames before `fault_index_`, one after another, that had it, too
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point drawn_ = start_;
};

}  // namespace seqloop::program
