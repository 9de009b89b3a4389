// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>
#include <opencv2/core.hpp>
#include <utility>

#include "files/output_folder.hpp"
#include "program/drives/drives.hpp"
#include "program/drives/stills_options.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/opencv/file_codecs.hpp"

namespace seqloop::program {
namespace {

struct StillsVerbSettings {
  std::filesystem::path source;
  std::filesystem::path out;
  std::string format = "png";
  DriveSettings drive;
  StillsSettings stills;
};

/// Looks on while frames are grabbed: between two stills there may be minutes of them. Ends the
/// drive when the program is asked to stop.
class WatchedSource : public FrameSource {
 public:
  explicit WatchedSource(std::unique_ptr<FrameSource> source)
      : source_(std::move(source)), progress_("taking stills", source_->frame_count()) {}

  Grab grab(Frame& frame) noexcept override {
    if (interrupted()) return Grab::end;
    const Grab grab = source_->grab(frame);
    newest_ = frame.index;
    try {
      progress_.step();
    } catch (...) {  // a line less
    }
    return grab;
  }

  std::optional<std::uint64_t> frame_count() const noexcept override {
    return source_->frame_count();
  }

  std::vector<std::string> notes() const override { return source_->notes(); }

  /// The frame that was grabbed last.
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_; }
  [[nodiscard]] Progress& progress() noexcept { return progress_; }

 private:
  std::unique_ptr<FrameSource> source_;
  Progress progress_;
  std::uint64_t newest_ = 0;
};

std::vector<unsigned char> encode(const Image& image, const std::string& format) {
  // cv::Mat has no view of constant pixels; this one is only read.
  const cv::Mat picture(image.height, image.width,
                        image.format == PixelFormat::gray8 ? CV_8UC1 : CV_8UC3,
                        const_cast<std::uint8_t*>(image.data), image.stride);
  std::vector<unsigned char> bytes;
  bool encoded = false;
  try {
    encoded = opencv::file_codecs().encode("." + format, picture, bytes);
  } catch (const cv::Exception&) {  // sizes that the format cannot hold
  }
  if (!encoded) {
    throw files::IoError("stills", fmt::format("a picture of {}x{} cannot be written as {}",
                                               image.width, image.height, format));
  }
  return bytes;
}

/// Everything that the stills need, opened and checked.
struct Setup {
  std::unique_ptr<files::OutputFolder> out;
  std::unique_ptr<FrameSource> stills;
  WatchedSource* source = nullptr;  ///< inside of the stills
};

Setup set_up(const StillsVerbSettings& settings, Faults faults) {
  Setup setup;
  std::unique_ptr<WatchedSource> source;
  if (is_described(settings.source)) {
    faults.push_back({"source", settings.source.string() + " holds descriptors, no pictures",
                      "give an image folder or a video"});
  } else {
    collect(faults, [&] {
      source =
          std::make_unique<WatchedSource>(open_drive(settings.source, "source", settings.drive));
    });
  }
  check_reading(settings.drive, {&settings.source, 1}, faults);
  if (settings.out.empty()) {
    faults.push_back({"out", "not given", "--out DIR"});
  } else {
    collect(faults, [&] { setup.out = std::make_unique<files::OutputFolder>(settings.out); });
  }
  setup.source = source.get();
  collect(faults, [&] {
    refuse(validate(settings.stills));
    if (source) setup.stills = make_stills(std::move(source), settings.stills);
  });
  refuse(std::move(faults));
  return setup;
}

void take_stills(const StillsVerbSettings& settings, Faults faults) {
  take_interruptions();
  const Setup setup = set_up(settings, std::move(faults));
  files::OutputFolder& out = *setup.out;
  FrameSource& stills = *setup.stills;
  WatchedSource& source = *setup.source;

  std::string table = "still,source_frame,time_s\n";
  std::uint64_t taken = 0;
  std::uint64_t unreadable = 0;
  Frame frame;
  for (Grab grab = stills.grab(frame); grab != Grab::end; grab = stills.grab(frame)) {
    const std::string name = fmt::format("{:06}.{}", taken++, settings.format);
    if (grab == Grab::frame) {
      const std::vector<unsigned char> bytes = encode(frame.image, settings.format);
      out.write(name, std::as_bytes(std::span(bytes)));
    } else {
      // An empty file is a picture that cannot be read, too, and keeps its number.
      out.write(name, "");
      ++unreadable;
      source.progress().tell_fault(fmt::format("frame {}", source.newest()), frame.index,
                                   frame.fault);
    }
    table += fmt::format("{},{},{:.9g}\n", frame.index, source.newest(), frame.time_s);
  }
  source.progress().done();
  stop_if_interrupted();
  tell_notes(settings.source, stills);
  if (taken == 0) {
    throw SetupError({settings.source.string(), "no frame of it lies in what is asked for",
                      "see --from-s, --to-s and --leave-out"});
  }
  if (taken == unreadable) {
    throw SetupError({settings.source.string(), "none of the frames asked for can be read"});
  }
  out.write("stills.csv", table);
  out.commit();
  say("{} in {}", counted(taken, "still"), settings.out.string());
  if (unreadable > 0) say("empty files: {}", counted(unreadable, "unreadable frame"));
}

}  // namespace

Verb stills_verb() {
  const auto settings = std::make_shared<StillsVerbSettings>();
  Verb verb{"stills",
            "Take stills of a drive at even times, resized and cropped",
            {},
            [settings](Faults faults) { take_stills(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.path("source", Access::reads, settings->source, "image folder, video file or bag");
  verb.options.folder("out", settings->out, {}, "folder to make: 000000.png ... and stills.csv");
  verb.options.add(
      {"format", ValueKind::text, "png or jpg [png]", [settings](std::string_view value) {
         if (value != "png" && value != "jpg") {
           throw std::invalid_argument("'" + std::string(value) + "' is neither png nor jpg");
         }
         settings->format = value;
       }});
  verb.options.number("fps", settings->drive.fps, "frames a second of an image folder [10]");
  verb.options.text("topic", settings->drive.topic,
                    "of a bag: which pictures [the only topic that has any]");
  add_stills_options(verb.options, settings->stills);
  return verb;
}

}  // namespace seqloop::program
