// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace seqloop {

/// How far a frame came, in the order of the pipeline.
enum class Gate : std::uint8_t {
  no_frame,      ///< a live source brought no frame in time, or lost its camera
  frame_error,   ///< the newest frame could not be read or described
  warming_up,    ///< fewer than ds + 1 frames have been seen
  no_candidate,  ///< no line fits into the rows that may be searched
  not_unique,    ///< there is a best row, but another stands out nearly as much
  match          ///< the robot has been here before
};

/// How many gates there are.
inline constexpr std::size_t gates = 6;

/// `no_frame`, `frame_error`, ...
[[nodiscard]] std::string_view name(Gate gate) noexcept;

/// The best row of the map for a frame.
struct Match {
  /// The place at the centre column, by its number: places are counted from 0 as they are added,
  /// those that a full map forgets too.
  std::size_t place = 0;
  float score = 0.0F;  ///< mean difference along the line, 0 .. 2; smaller is more certain
  /// Score by the runner-up's score: 0 .. 1; above 1 or infinite when the runner-up of the last
  /// full search had to stand in and is better; NaN where not defined.
  float uniqueness = 0.0F;
  double velocity = 0.0;  ///< rows a frame; NaN for single frames
  std::size_t head = 0;   ///< the place at the newest column
};

/// What a frame cost. Follows from configuration and input alone, never from the machine.
struct Work {
  std::uint64_t candidates = 0;  ///< rows that got a score
  std::uint64_t distances = 0;   ///< descriptor distances computed
  std::uint64_t line_sums = 0;   ///< lines summed, of ds + 1 differences each
  std::uint64_t scanned = 0;     ///< to relocalise: places looked at by 32 bytes of their sketches
  std::uint64_t sketches = 0;    ///< to relocalise: pairs of sketches compared by 128 bytes

  bool operator==(const Work&) const = default;
};

/// The answer to one frame.
struct FrameReport {
  std::uint64_t newest = 0;            ///< the frame that was stepped, from 0
  std::optional<std::uint64_t> frame;  ///< the centre frame, which the answer is about, once known
  Gate gate = Gate::frame_error;
  std::optional<Match> match;  ///< at the gates `not_unique` and `match`
  std::size_t k = 0;           ///< K in force for this frame; 0 where all rows are candidates
  bool full_search = false;    ///< whether all rows were candidates
  bool map_full = false;       ///< closing loops: the frame could not become a place
  Work work;
};

}  // namespace seqloop
