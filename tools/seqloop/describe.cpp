#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

#include "files/npy_file.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/drives.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/outputs.hpp"
#include "seqloop/pipeline.hpp"
#include "seqloop/progress.hpp"
#include "seqloop/say.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

struct DescribeSettings {
  std::filesystem::path source;
  std::filesystem::path out;
  DriveSettings drive;
};

void describe(const DescribeSettings& settings, Faults faults) {
  take_interruptions();
  std::unique_ptr<Describer> describer;
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<files::NpyWriter> out;
  collect(faults, [&] { describer = open_describer(settings.drive); });
  if (is_described(settings.source)) {
    faults.push_back({"source", settings.source.string() + " holds descriptors already",
                      "give an image folder or a video"});
  } else {
    collect(faults, [&] { source = open_drive(settings.source, "source", settings.drive); });
  }
  refuse_overwriting(faults, settings.out, {settings.source});
  if (settings.out.empty()) {
    faults.push_back({"out", "not given", "--out D.npy"});
  } else {
    const std::size_t size = describer ? describer->size() : 1;
    collect(faults, [&] { out = std::make_unique<files::NpyWriter>(settings.out, size); });
  }
  refuse(std::move(faults));

  std::size_t unreadable = 0;
  std::size_t blank = 0;
  std::vector<float> descriptor(describer->size());
  Progress progress("describing", source->frame_count());
  Frame frame;
  for (Grab grab = source->grab(frame); grab != Grab::end; grab = source->grab(frame)) {
    stop_if_interrupted();
    const auto [described, fault] = seqloop::describe(grab, frame, describer.get(), descriptor);
    if (described.empty()) {
      // A row of zeros keeps the rows in step with the frames.
      std::ranges::fill(descriptor, 0.0F);
      ++unreadable;
      progress.tell(fmt::format("frame {}: {}", frame.index, fault));
    } else if (squared_norm(described) == 0.0) {
      ++blank;
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
  say("{} frames of {} values in {}", rows, descriptor.size(), settings.out.string());
  if (unreadable > 0) say("{} unreadable frames are rows of zeros", unreadable);
  if (blank > 0) say("{} blank frames, without any feature, are rows of zeros", blank);
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
