// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "seqloop/frame_source.hpp"

namespace seqloop::experiment {

/// Which frames of two drives along one route show nothing to be recognised. Both numbers are grey
/// levels, 0..255, of pictures reduced to 64x32 pixels; 0: none is left out for that.
///
/// The defaults are read off Nordland's summer and winter (64x32, one still a second): in tunnels
/// the mean stays below 40 and outside, but for one frame, above 50; where a train halts neighbours
/// differ by less than 5, mostly by less than 1, and at its usual speed by more than 10. They leave
/// out 406 of 2,400 frames, 135 dark and 271 standing.
struct LeaveOutRule {
  double dark_below = 40.0;     ///< mean grey: tunnels
  double standing_below = 5.0;  ///< mean absolute difference to the frame kept last: halts
};

/// The frames of two drives that are worth comparing.
struct KeptFrames {
  std::vector<std::uint64_t> frames;  ///< ascending; the same in both drives
  std::uint64_t dark = 0;             ///< left out because they were dark
  std::uint64_t standing = 0;         ///< left out because they were not, but standing
};

/// What the paper did by hand. A frame goes when it is dark in one of the drives, or when one of
/// them stands: then its place is there several times, and no answer could be right. A frame that
/// cannot be read stays, since nobody knows what it shows.
///
/// @param reference, query frame i of one was taken where frame i of the other was; read to the end
/// Throws SetupError: the rule's numbers, drives of different length, descriptors.
/// Work: reduces every picture. Allocates: yes.
[[nodiscard]] KeptFrames leave_out(FrameSource& reference, FrameSource& query,
                                   const LeaveOutRule& rule);

}  // namespace seqloop::experiment
