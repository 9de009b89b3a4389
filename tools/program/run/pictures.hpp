// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "program/map/lasting_map.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// What comes into the folder of pictures.
inline constexpr const char* matrix_name = "difference_matrix.png";
inline constexpr const char* sheet_name = "matches.png";

/// Keeps what pictures of a run need, while it runs: at most 1,000 descriptors, thinned out evenly
/// as the drive grows, and the accepted answers.
class PictureRecorder {
 public:
  /// @param difference what the matrix shows
  explicit PictureRecorder(Difference difference) noexcept : difference_(difference) {}

  /// Takes a frame. @param query about what the detector compared, as `Detector::newest_query`
  /// gives it
  void add(std::uint64_t frame, std::span<const float> query);

  /// Takes answers, of which those that are accepted are shown.
  void add(std::span<const Answer> answers);

  /// Writes `difference_matrix.png`: places upwards, frames to the right, dark where they are
  /// alike, and the matches on it. Throws files::IoError, SetupError.
  void write_matrix(const std::filesystem::path& folder, const PlaceMap& map) const;

  /// Opens a drive anew, from its first frame.
  using Reopen = std::function<std::unique_ptr<FrameSource>()>;

  /// Writes `matches.png`: frames of the drive and the places they were matched with, side by side,
  /// evenly over the drive. @return false when there are none to show. Throws as write_matrix does.
  bool write_pairs(const std::filesystem::path& folder, const Reopen& query,
                   const Reopen& reference) const;

  /// The same of a map that lasts, with places of earlier sessions as its thumbnails show them, as
  /// far as it has any. @param own the session that the drive has become; empty: none
  bool write_pairs(const std::filesystem::path& folder, const Reopen& query, const LastingMap& map,
                   const std::string& own) const;

 private:
  [[nodiscard]] std::vector<Answer> chosen() const;

  Difference difference_;
  std::uint64_t step_ = 1;  // every step_-th frame is kept
  std::vector<std::vector<float>> queries_;
  std::vector<Answer> matches_;
};

}  // namespace seqloop::program
