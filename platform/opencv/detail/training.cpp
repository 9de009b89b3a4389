// SPDX-License-Identifier: MIT
#include "opencv/detail/training.hpp"

#include "opencv/detail/one_line.hpp"
#include "opencv/detail/picture_view.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {

TrainingCount for_each_picture(std::span<FrameSource* const> drives,
                               const std::function<void(const Image&)>& visit) {
  TrainingCount count;
  Frame frame;
  for (FrameSource* drive : drives) {
    for (Grab grab = drive->grab(frame); grab != Grab::end; grab = drive->grab(frame)) {
      if (grab == Grab::unreadable || !fault_of(frame.image).empty()) {
        ++count.unreadable;
        continue;
      }
      try {
        visit(frame.image);
      } catch (const cv::Exception& error) {
        throw SetupError(Fault{"training", "OpenCV: " + one_line(error.err)});
      }
      ++count.pictures;
    }
  }
  return count;
}

std::string text(const TrainingCount& count) {
  std::string words = counted(count.pictures, "picture") + " that can be read";
  if (count.unreadable > 0) words += " and " + std::to_string(count.unreadable) + " that cannot";
  return words;
}

}  // namespace seqloop::opencv
