// SPDX-License-Identifier: MIT
#include "program/drives/stills_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "opencv/picture_resizer.hpp"
#include "program/options/verb.hpp"

namespace seqloop::program {
namespace {

/// A moment counts as reached this much earlier, so that rounding loses no frame.
constexpr double slack_s = 1e-6;
constexpr double least_every_s = 1e-3;

bool lies_in(const Crop& crop, int width, int height) {
  return crop.x + crop.width <= width && crop.y + crop.height <= height;
}

std::string text_of(const Crop& crop) {
  return fmt::format("{}x{}+{}+{}", crop.width, crop.height, crop.x, crop.y);
}

Fault too_large(const Crop& crop, int width, int height) {
  return {"crop", fmt::format("{} does not lie in pictures of {}x{}", text_of(crop), width, height),
          "WxH+X+Y counts from the left top corner, after --size"};
}

Image cut_out(const Image& picture, const Crop& crop) {
  const std::size_t pixel = picture.format == PixelFormat::gray8 ? 1 : 3;
  Image part = picture;
  part.data +=
      static_cast<std::size_t>(crop.y) * picture.stride + static_cast<std::size_t>(crop.x) * pixel;
  part.width = crop.width;
  part.height = crop.height;
  return part;
}

class StillsSource : public FrameSource {
 public:
  StillsSource(std::unique_ptr<FrameSource> source, StillsSettings settings)
      : source_(std::move(source)),
        settings_(std::move(settings)),
        resizer_(settings_.width, settings_.height, settings_.gray) {
    if (settings_.crop.width == 0 || settings_.width > 0) return;
    Frame first;
    const Grab grab = source_->grab(first);
    ahead_ = {grab, first};
    if (grab == Grab::frame && !lies_in(settings_.crop, first.image.width, first.image.height)) {
      throw SetupError(too_large(settings_.crop, first.image.width, first.image.height));
    }
  }

  Grab grab(Frame& frame) noexcept override {
    while (!ended_) {
      const Grab grab = grab_source(frame);
      ended_ = grab == Grab::end || frame.time_s + slack_s >= settings_.to_s;
      if (ended_ || !wanted(frame.time_s + slack_s)) continue;
      frame.index = next_++;
      return grab == Grab::frame ? shape(frame) : grab;
    }
    frame = Frame{};
    frame.index = next_;
    return Grab::end;
  }

  std::optional<std::uint64_t> frame_count() const noexcept override {
    const bool all = settings_.every_s == 0.0 && settings_.from_s == 0.0 &&
                     std::isinf(settings_.to_s) && settings_.leave_out.empty();
    return all ? source_->frame_count() : std::nullopt;
  }

  std::vector<std::string> notes() const override { return source_->notes(); }

 private:
  Grab grab_source(Frame& frame) noexcept {
    if (!ahead_) return source_->grab(frame);
    frame = ahead_->second;
    return std::exchange(ahead_, std::nullopt)->first;
  }

  /// Ticks go on where nothing is taken, so that what is left out moves no later still.
  bool wanted(double time_s) noexcept {
    bool due = true;
    if (settings_.every_s > 0.0) {
      const double tick = std::floor(time_s / settings_.every_s);
      due = tick > tick_;
      tick_ = tick;
    }
    return due && time_s >= settings_.from_s &&
           std::ranges::none_of(settings_.leave_out, [&](const Interval& interval) {
             return time_s >= interval.from_s && time_s < interval.to_s;
           });
  }

  Grab shape(Frame& frame) noexcept {
    const bool changes = settings_.width > 0 || settings_.gray || settings_.crop.width > 0;
    if (!changes) return Grab::frame;
    if (frame.image.data == nullptr) return refuse_frame(frame, "it has no picture");
    frame.image = resizer_.resize(frame.image);
    if (frame.image.data == nullptr) return refuse_frame(frame, "out of memory");
    if (settings_.crop.width == 0) return Grab::frame;
    if (!lies_in(settings_.crop, frame.image.width, frame.image.height)) {
      return refuse_frame(frame, "the picture is too small for the crop");
    }
    frame.image = cut_out(frame.image, settings_.crop);
    return Grab::frame;
  }

  static Grab refuse_frame(Frame& frame, std::string_view why) noexcept {
    frame.image = {};
    frame.descriptor = {};
    frame.fault = why;
    return Grab::unreadable;
  }

  std::unique_ptr<FrameSource> source_;
  StillsSettings settings_;
  opencv::PictureResizer resizer_;
  std::optional<std::pair<Grab, Frame>> ahead_;  ///< looked at, but not handed over yet
  double tick_ = -1.0;                           ///< multiple of every_s reached last
  std::uint64_t next_ = 0;
  bool ended_ = false;
};

}  // namespace

Faults validate(const StillsSettings& settings) {
  Faults faults;
  if (!(settings.every_s == 0.0 || settings.every_s >= least_every_s)) {
    faults.push_back({"every-s", fmt::format("{} is below 0.001 seconds", settings.every_s)});
  }
  if (!(settings.from_s >= 0.0)) {
    faults.push_back({"from-s", fmt::format("{} is below 0", settings.from_s)});
  }
  if (!(settings.to_s > settings.from_s)) {
    faults.push_back({"to-s", fmt::format("{} does not come after --from-s, {}", settings.to_s,
                                          settings.from_s)});
  }
  for (const Interval& interval : settings.leave_out) {
    if (interval.from_s >= 0.0 && interval.to_s > interval.from_s) continue;
    faults.push_back({"leave-out", fmt::format("{} to {} seconds is no span of time",
                                               interval.from_s, interval.to_s)});
  }
  if (settings.width > 0 && settings.crop.width > 0 &&
      !lies_in(settings.crop, settings.width, settings.height)) {
    faults.push_back(too_large(settings.crop, settings.width, settings.height));
  }
  return faults;
}

std::unique_ptr<FrameSource> make_stills(std::unique_ptr<FrameSource> source,
                                         StillsSettings settings) {
  refuse(validate(settings));
  return std::make_unique<StillsSource>(std::move(source), std::move(settings));
}

}  // namespace seqloop::program
