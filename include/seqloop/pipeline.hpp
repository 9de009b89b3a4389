// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "seqloop/clock.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/frame_report.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop {

/// Where a frame's time went.
struct StageTimes {
  Nanoseconds age{0};   ///< from when the picture was taken to when it was taken up; live sources
  Nanoseconds grab{0};  ///< reading and decoding, without waiting for the camera
  Nanoseconds describe{0};
  Nanoseconds match{0};
  Nanoseconds total{0};  ///< grab, describe and match
};

/// What the pipeline says of one frame.
struct ProcessedFrame {
  Frame frame;                        ///< as grabbed; valid until the next frame
  std::span<const float> descriptor;  ///< [D]; empty where there is none. Valid as long
  FrameReport report;
  std::string_view fault;  ///< why the gate is `frame_error` or `no_frame`; empty otherwise
  StageTimes times;
};

/// A frame's descriptor, or why there is none.
struct DescribedFrame {
  std::span<const float> descriptor;  ///< [D]; empty when the frame cannot be read or described
  std::string_view fault;
  bool blank = false;  ///< the describer found no feature in the picture
};

/// @param grab, frame what a source handed over, `end` excepted
/// @param describer   may be null when the source hands over descriptors
/// @param buffer [D] that a picture's descriptor is written to
/// Allocates: what the describer does.
[[nodiscard]] DescribedFrame describe(Grab grab, const Frame& frame, Describer* describer,
                                      std::span<float> buffer) noexcept;

/// Grab, describe, match: one frame in, one report out.
class Pipeline {
 public:
  /// All of them live longer than the pipeline.
  /// @param describer       may be null when the source hands over descriptors
  /// @param descriptor_size that of the describer and the detector
  /// Errors: SetupError, when the describer's is another than either. Allocates: one descriptor.
  Pipeline(FrameSource& source, Describer* describer, Detector& detector, Clock& clock,
           std::size_t descriptor_size);

  /// Takes the next frame through all stages. Frames that were lost or dropped just before it are
  /// skipped in the detector, so that `report.newest` counts them as `Detector::skip` says.
  /// @return none when the drive is over; at the gate `no_frame`, nothing came and nothing was done
  /// Errors: none thrown. Allocates: what source and describer do; matching never.
  [[nodiscard]] std::optional<ProcessedFrame> process() noexcept;

 private:
  FrameSource* source_;
  Describer* describer_;
  Detector* detector_;
  Clock* clock_;
  std::vector<float> descriptor_;
};

}  // namespace seqloop
