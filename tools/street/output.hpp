// SPDX-License-Identifier: MIT
// Frames and truth to files, without half-written ones under their final names.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "truth.hpp"

namespace seqloop::street {

enum class Format { jpg, png, avi };

/// Takes the frames of one drive in order. Throws std::runtime_error with the reason.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void put(const cv::Mat& image) = 0;
  /// Writes what is still held back and checks that all of it is there.
  virtual void close() = 0;
};

/// @param folder exists. @return images 000000.jpg and so on in folder/name, or folder/name.avi.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& folder, const std::string& name,
                                     Format format, cv::Size size);

/// Writes query,reference rows below a header.
void write_truth(const std::filesystem::path& file, const std::vector<TruthRow>& rows);

/// Writes query,first,last rows below a header.
void write_near(const std::filesystem::path& file, const std::vector<NearRow>& rows);

/// Writes where the camera of each frame was: metres along the street, to the left of its middle
/// and above it; radians left of its direction, up, and clockwise.
void write_poses(const std::filesystem::path& file, const Drive& drive);

/// Writes text to a file, all of it or an exception.
void write_file(const std::filesystem::path& file, const std::string& text);

/// A folder that takes its final name only when it is complete.
class Staging {
 public:
  /// Names the file that marks a folder as made here.
  static constexpr const char* kMarker = "street.txt";

  /// @throws std::runtime_error when `target` exists and was not made by this program, or holds
  ///   what was not.
  explicit Staging(std::filesystem::path target);
  /// Removes what was not committed.
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const std::filesystem::path& folder() const noexcept { return folder_; }
  /// Writes the marker and puts the folder in the place of the target.
  void commit(const std::string& parameters);

  /// @return true when target was made here with the same parameters.
  static bool holds(const std::filesystem::path& target, const std::string& parameters);

 private:
  std::filesystem::path target_, folder_;
};

}  // namespace seqloop::street
