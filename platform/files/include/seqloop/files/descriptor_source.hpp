// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "seqloop/files/npy_file.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::files {

/// A drive that was described before: every row of a matrix is one frame.
class DescriptorSource : public FrameSource {
 public:
  /// @param frames_per_second > 0; frame i is at i / frames_per_second. Throws SetupError
  /// otherwise.
  explicit DescriptorSource(Matrix descriptors, double frames_per_second = 10.0);

  /// Sets `Frame::descriptor`, never `Frame::image`. Allocates: never.
  [[nodiscard]] Grab grab(Frame& frame) noexcept override;

  [[nodiscard]] std::optional<std::uint64_t> frame_count() const noexcept override;

  /// Values in one descriptor, D.
  [[nodiscard]] std::size_t size() const noexcept { return descriptors_.columns; }

 private:
  Matrix descriptors_;
  double frames_per_second_;
  std::size_t next_ = 0;
};

}  // namespace seqloop::files
