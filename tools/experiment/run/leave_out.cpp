// SPDX-License-Identifier: MIT
#include "experiment/run/leave_out.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "opencv/picture_resizer.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::experiment {
namespace {

constexpr int width = 64;  // pixels
constexpr int height = 32;
constexpr std::size_t pixels = std::size_t{width} * height;
using Small = std::array<std::uint8_t, pixels>;

double mean(const Small& picture) {
  return std::accumulate(picture.begin(), picture.end(), 0.0) / static_cast<double>(pixels);
}

double difference(const Small& a, const Small& b) {
  int sum = 0;
  for (std::size_t i = 0; i < pixels; ++i) sum += std::abs(int{a[i]} - int{b[i]});
  return static_cast<double>(sum) / static_cast<double>(pixels);
}

/// One of the two drives, frame by frame.
class Drive {
 public:
  explicit Drive(FrameSource& source) : source_(source) {}

  /// @return false at the end. Throws SetupError: the frame has no picture.
  bool grab() {
    Frame frame;
    now_.reset();
    const Grab grab = source_.grab(frame);
    if (grab != Grab::frame) return grab == Grab::unreadable;
    if (frame.image.data == nullptr) {
      throw SetupError({"leaving out", "a drive of descriptors does not show what is dark",
                        "give image folders or videos"});
    }
    const Image small = resizer_.resize(frame.image);
    if (small.data == nullptr) return true;
    Small& into = now_.emplace();
    for (std::size_t y = 0; y < height; ++y) {
      std::copy_n(small.data + y * small.stride, width, into.begin() + y * width);
    }
    return true;
  }

  [[nodiscard]] bool dark(double below) const { return now_ && mean(*now_) < below; }

  [[nodiscard]] bool standing(double below) const {
    return now_ && kept_ && difference(*now_, *kept_) < below;
  }

  void keep() {
    if (now_) kept_ = now_;
  }

 private:
  FrameSource& source_;
  opencv::PictureResizer resizer_{width, height, true};
  std::optional<Small> now_;   ///< none when it cannot be read
  std::optional<Small> kept_;  ///< the newest readable one that was kept
};

void check(const LeaveOutRule& rule) {
  Faults faults;
  for (const auto& [name, level] : {std::pair{"dark_below", rule.dark_below},
                                    std::pair{"standing_below", rule.standing_below}}) {
    if (!(level >= 0.0 && level <= 255.0)) {
      faults.push_back({name, std::to_string(level) + " is no grey level from 0 to 255"});
    }
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
}

}  // namespace

KeptFrames leave_out(FrameSource& reference, FrameSource& query, const LeaveOutRule& rule) {
  check(rule);
  Drive one(reference);
  Drive other(query);
  KeptFrames kept;
  for (std::uint64_t frame = 0;; ++frame) {
    const bool more = one.grab();
    if (other.grab() != more) {
      throw SetupError(
          {"leaving out",
           "one drive ends at frame " + std::to_string(frame) + " and the other does not",
           "frame i of both must show the same place"});
    }
    if (!more) return kept;
    if (one.dark(rule.dark_below) || other.dark(rule.dark_below)) {
      ++kept.dark;
    } else if (one.standing(rule.standing_below) || other.standing(rule.standing_below)) {
      ++kept.standing;
    } else {
      one.keep();
      other.keep();
      kept.frames.push_back(frame);
    }
  }
}

}  // namespace seqloop::experiment
