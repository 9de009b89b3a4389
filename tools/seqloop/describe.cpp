#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

#include "files/npy_file.hpp"
#include "seqloop/drives.hpp"
#include "seqloop/progress.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

struct DescribeSettings {
  std::filesystem::path source;
  std::filesystem::path out;
  DriveSettings drive;
};

void describe(const DescribeSettings& settings, Faults faults) {
  std::unique_ptr<Describer> describer;
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<files::NpyWriter> out;
  collect(faults, [&] { describer = open_describer(settings.drive); });
  if (is_described(settings.source)) {
    faults.push_back({"source", settings.source.string() + " holds descriptors already",
                      "give an image folder or a video"});
  } else {
    collect(faults, [&] { source = open_drive(settings.source, "source", false, settings.drive); });
  }
  if (settings.out.empty()) faults.push_back({"out", "not given", "--out D.npy"});
  refuse(std::move(faults));
  out = std::make_unique<files::NpyWriter>(settings.out, describer->size());

  std::size_t unreadable = 0;
  std::vector<float> descriptor(describer->size());
  Progress progress("describing", source->frame_count());
  Frame frame;
  for (Grab grab = source->grab(frame); grab != Grab::end; grab = source->grab(frame)) {
    std::string_view fault = frame.fault;
    if (grab == Grab::frame &&
        describer->describe(frame.image, descriptor) == Description::failed) {
      fault = describer->last_fault();
    }
    if (!fault.empty()) {
      // A row of zeros keeps the rows in step with the frames.
      std::ranges::fill(descriptor, 0.0F);
      ++unreadable;
      progress.tell(fmt::format("frame {}: {}", frame.index, fault));
    }
    out->append(descriptor);
    progress.step();
  }
  progress.done();
  tell_notes(settings.source, *source);
  const std::size_t rows = out->rows();
  if (rows == unreadable) {
    throw SetupError({settings.source.string(), "none of its frames can be read"});
  }
  out->commit();
  fmt::print(
      stderr, "seqloop: {} frames of {} values in {}{}\n", rows, descriptor.size(),
      settings.out.string(),
      unreadable == 0 ? "" : fmt::format("; {} unreadable ones are rows of zeros", unreadable));
}

}  // namespace

Verb describe_verb() {
  const auto settings = std::make_shared<DescribeSettings>();
  Verb verb{
      "describe", "Write the descriptors of every frame of a drive", {}, [settings](Faults faults) {
        describe(*settings, std::move(faults));
      }};
  verb.options.path("source", settings->source, "image folder or video file");
  verb.options.path("out", settings->out, "descriptors: float32 [N, D], unit L2, .npy");
  add_drive_options(verb.options, settings->drive);
  return verb;
}

}  // namespace seqloop::program
