#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "files/output_file.hpp"
#include "seqloop/drive_length.hpp"
#include "seqloop/drives.hpp"
#include "seqloop/frame_json.hpp"
#include "seqloop/interruption.hpp"
#include "seqloop/map_builder.hpp"
#include "seqloop/matcher_settings.hpp"
#include "seqloop/outputs.hpp"
#include "seqloop/pictures.hpp"
#include "seqloop/pipeline.hpp"
#include "seqloop/progress.hpp"
#include "seqloop/run_summary.hpp"
#include "seqloop/say.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

struct RunSettings {
  std::filesystem::path source;
  std::filesystem::path reference;
  std::filesystem::path out = "-";
  std::filesystem::path pictures;
  Pace pace = Pace::max;
  double budget_ms = 40.0;
  std::size_t max_places = 0;
  DriveSettings drive;
  MatcherSettings matcher;
};

class SteadyClock : public Clock {
 public:
  static constexpr Nanoseconds slice = std::chrono::milliseconds(50);

  Nanoseconds now() noexcept override {
    return std::chrono::steady_clock::now().time_since_epoch();
  }
  void sleep_until(Nanoseconds moment) noexcept override {
    // In slices, so that a long wait can be interrupted.
    while (now() < moment && !interrupted()) {
      std::this_thread::sleep_for(std::min<Nanoseconds>(moment - now(), slice));
    }
  }
};

/// Everything that a run needs, opened and checked.
struct Setup {
  MatcherConfig config;
  std::unique_ptr<Describer> describer;  ///< none when nothing has to be described
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<FrameSource> reference;  ///< none when loops are closed
  std::unique_ptr<files::OutputFile> out;
  std::size_t descriptor_size = 0;
  std::size_t places = 0;
};

/// Rows that the map needs: asked for, or as many as the drive has, or a round number.
std::size_t places_for(const RunSettings& settings, const FrameSource& drive) {
  constexpr std::size_t unknown_length = 20'000;
  if (settings.max_places > 0) return settings.max_places;
  return static_cast<std::size_t>(drive.frame_count().value_or(unknown_length));
}

Setup set_up(const RunSettings& settings, Faults faults) {
  Setup setup;
  std::vector<std::filesystem::path> inputs = settings.drive.training;
  inputs.insert(inputs.end(), {settings.source, settings.reference});
  refuse_overwriting(faults, settings.out, inputs);
  collect(faults, [&] { setup.out = std::make_unique<files::OutputFile>(settings.out); });
  if (!settings.pictures.empty()) check_folder(faults, settings.pictures);
  const bool closing = settings.reference.empty();
  setup.config = resolve(settings.matcher, closing ? Use::close_loops : Use::localise, faults);
  if (!(settings.budget_ms > 0.0 && settings.budget_ms <= 1e9)) {
    faults.push_back({"budget-total", "it must be above 0 and at most 1e9 milliseconds"});
  }
  const bool pictures = !is_described(settings.source);
  DriveSettings drive = settings.drive;
  drive.difference = setup.config.difference;
  if (pictures || !(closing || is_described(settings.reference))) {
    suit_descriptor(drive, setup.config.difference, faults);
    collect(faults, [&] { setup.describer = open_describer(drive); });
  }
  collect(faults, [&] { setup.source = open_drive(settings.source, "source", drive); });
  if (!closing) {
    collect(faults, [&] { setup.reference = open_drive(settings.reference, "reference", drive); });
  }
  refuse(faults);

  setup.descriptor_size = descriptor_size(*setup.source, setup.describer.get());
  setup.places = places_for(settings, closing ? *setup.source : *setup.reference);
  if (setup.reference) {
    const std::size_t size = descriptor_size(*setup.reference, setup.describer.get());
    if (size != setup.descriptor_size) {
      faults.push_back(
          {"reference, source",
           fmt::format("descriptors of {} and of {} values", size, setup.descriptor_size),
           "describe both with the same model and layer"});
    }
  }
  if (const auto frames = setup.source->frame_count()) {
    check_length(faults, setup.config, *frames, setup.places);
  }
  refuse(std::move(faults));
  return setup;
}

void write_pictures(const RunSettings& settings, const PictureRecorder& recorder,
                    const PlaceMap& map) {
  const auto reopen = [&](const std::filesystem::path& path) {
    return [&settings, path] { return open_drive(path, "source", settings.drive); };
  };
  recorder.write_matrix(settings.pictures, map);
  const bool pairs = recorder.write_pairs(
      settings.pictures, reopen(settings.source),
      reopen(settings.reference.empty() ? settings.source : settings.reference));
  say("pictures in {}: difference_matrix.png{}", settings.pictures.string(),
      pairs ? ", matches.png" : "; no matched pictures to show side by side");
}

void run(const RunSettings& settings, Faults faults) {
  take_interruptions();
  const Setup setup = set_up(settings, std::move(faults));
  files::OutputFile& out = *setup.out;
  if (!settings.pictures.empty()) make_folder(settings.pictures);
  PlaceMap map({setup.places, setup.descriptor_size});
  if (setup.reference) {
    Progress mapping("mapping", setup.reference->frame_count());
    fill_map(map, *setup.reference, setup.describer.get(), setup.config, mapping);
    tell_notes(settings.reference, *setup.reference);
  }
  Detector detector(setup.config, map);
  SteadyClock clock;
  Pipeline pipeline(*setup.source, setup.describer.get(), detector, clock, setup.descriptor_size,
                    settings.pace);
  RunSummary summary(std::chrono::duration_cast<Nanoseconds>(
      std::chrono::duration<double, std::milli>(settings.budget_ms)));
  PictureRecorder recorder(setup.config.difference);

  Progress progress("running", setup.source->frame_count());
  while (!interrupted()) {
    const std::optional<ProcessedFrame> processed = pipeline.process();
    if (!processed) break;
    const bool deadline_missed = summary.add(*processed);
    out.write(frame_json(*processed, deadline_missed));
    out.flush();
    if (!processed->fault.empty()) {
      progress.tell(fmt::format("frame {}: {}", processed->frame.index, processed->fault));
    }
    if (!settings.pictures.empty()) recorder.add(processed->report, detector.newest_query());
    progress.step();
  }
  progress.done();
  tell_notes(settings.source, *setup.source);
  if (summary.frames() > 0 && summary.frames() == summary.errors()) {
    throw SetupError({settings.source.string(), "none of its frames can be read"});
  }
  out.commit();
  if (!settings.pictures.empty()) write_pictures(settings, recorder, map);
  say_raw("seqloop: " + summary.text());
}

Pace parse_pace(std::string_view text) {
  if (text == "max") return Pace::max;
  if (text == "live") return Pace::live;
  throw std::invalid_argument("'" + std::string(text) + "' is neither live nor max");
}

}  // namespace

Verb run_verb() {
  const auto settings = std::make_shared<RunSettings>();
  settings->matcher.method = "o-seqcnnslam";
  Verb verb{
      "run", "Grab, describe, match and decide, frame by frame", {}, [settings](Faults faults) {
        run(*settings, std::move(faults));
      }};
  verb.options.path("source", settings->source, "image folder, video file or descriptors (.npy)");
  verb.options.path("reference", settings->reference,
                    "drive to localise in [close loops within the source]");
  verb.options.path("out", settings->out, "one JSON object a frame [standard output]");
  verb.options.path("pictures", settings->pictures,
                    "folder for the difference matrix and a sheet of matched pairs");
  verb.options.add({"pace", ValueKind::text,
                    "live: at the recording's own rate; max: as fast as it goes [max]",
                    [settings](std::string_view value) { settings->pace = parse_pace(value); }});
  verb.options.number("budget-total", settings->budget_ms,
                      "milliseconds that a frame may take before it counts as missed [40]");
  verb.options.count("max-places", settings->max_places,
                     "room in the map [as long as the drive, 20000 where that is not known]");
  add_drive_options(verb.options, settings->drive);
  add_matcher_options(verb.options, settings->matcher);
  return verb;
}

}  // namespace seqloop::program
