// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "program/process/progress.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// A frame that has an answer, and what the search for it, as the centre of its window, took.
struct MatchedFrame {
  Answer answer;  ///< with a match
  std::uint64_t candidates = 0;
  std::size_t k = 0;
  std::uint64_t distances = 0;
};

/// A recording that has been matched.
struct MatchedDrive {
  std::vector<MatchedFrame> frames;  ///< in order
  std::size_t blank_frames = 0;      ///< of the query

  [[nodiscard]] std::size_t accepted() const noexcept;
};

/// Who is told of a recording's frames; each may be missing.
struct MatchWatch {
  Progress* progress = nullptr;
  std::function<void()> between = {};  ///< every 64 frames at least; may throw to end the work
  std::function<void(const FrameReport&)> report = {};
  std::function<void(std::span<const Answer>)> rest = {};  ///< what `Detector::finish` gave
};

/// Adds faults where two drives have descriptors of different sizes, or are too short for any
/// answer. @param reference none: loops are closed within the query
void check_match(Faults& faults, const MatcherConfig& config, const files::Matrix* reference,
                 const files::Matrix& query);

/// The map that a recording is matched in: of the reference or, without one, empty, with room for
/// the recording itself. @param between as in MatchWatch
[[nodiscard]] PlaceMap map_for(const MatcherConfig& config, std::optional<files::Matrix> reference,
                               const files::Matrix& query,
                               const std::function<void()>& between = {});

/// Steps through a recording whose rows are of unit length where Euclid compares.
/// @param config the detector's; `frames_at_once` of them are taken together
[[nodiscard]] MatchedDrive match_frames(Detector& detector, const MatcherConfig& config,
                                        const files::Matrix& query, const MatchWatch& watch);

/// Matches a recording with a reference or, without one, with itself.
/// Throws SetupError, all faults at once.
[[nodiscard]] MatchedDrive match_drive(MatcherConfig config, std::optional<files::Matrix> reference,
                                       const files::Matrix& query, const MatchWatch& watch);

}  // namespace seqloop::program
