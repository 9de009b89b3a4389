// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/fixed_text.hpp"
#include "seqloop/frame_report.hpp"

namespace seqloop::program {

/// A frame of this drive that was at a place of another robot.
struct OtherLoop {
  Answer answer;    ///< accepted; its place is the number of its frame in that robot's session
  FixedText robot;  ///< names of the two
  FixedText session;
};

}  // namespace seqloop::program
