// SPDX-License-Identifier: MIT
#include "program/verbs/run.hpp"

#include <fmt/format.h>

#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "program/drives/map_builder.hpp"
#include "program/drives/source_numbers.hpp"
#include "program/drives/warm_up.hpp"
#include "program/fleet/fleet.hpp"
#include "program/options/verb.hpp"
#include "program/process/attempts.hpp"
#include "program/process/interruption.hpp"
#include "program/process/outputs.hpp"
#include "program/process/progress.hpp"
#include "program/process/say.hpp"
#include "program/run/frame_lines.hpp"
#include "program/run/pictures.hpp"
#include "program/run/run_report.hpp"
#include "program/run/run_summary.hpp"
#include "program/run/trouble_log.hpp"
#include "program/watch/ros_answers.hpp"
#include "program/watch/serving.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/linux/real_time.hpp"
#include "seqloop/linux/steady_clock.hpp"
#include "seqloop/linux/touched_memory.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {
namespace {

/// @param lasting the map of the run; null: it ends with it
void write_pictures(const RunSettings& settings, const PictureRecorder& recorder,
                    const PlaceMap& map, const LastingMap* lasting, Attempts& attempt) {
  const auto reopen = [&](const std::filesystem::path& path) {
    return [&settings, path] { return open_drive(path, "source", settings.drive); };
  };
  if (!attempt([&] { make_folder(settings.pictures); })) return;
  const bool matrix = attempt([&] { recorder.write_matrix(settings.pictures, map); });
  bool pairs = false;
  const bool looked = attempt([&] {
    pairs =
        lasting != nullptr
            ? recorder.write_pairs(settings.pictures, reopen(settings.source), *lasting,
                                   settings.map.read_only ? "" : lasting->sessions().back().name)
            : recorder.write_pairs(
                  settings.pictures, reopen(settings.source),
                  reopen(settings.reference.empty() ? settings.source : settings.reference));
  });
  if (!matrix || !looked) return;
  say("pictures in {}: {}{}", settings.pictures.string(), matrix_name,
      pairs ? fmt::format(", {}", sheet_name) : "; no matched pictures to show side by side");
}

ThreadCost since(const live::ThreadCounters& before) {
  const live::ThreadCounters now = live::thread_counters();
  return {now.minor_faults - before.minor_faults, now.major_faults - before.major_faults};
}

/// Throws when the thread may not be scheduled as asked, which was tried before.
void become_real_time(const RealTimeSettings& settings) {
  refuse(live::schedule(settings.work_thread(), "loop"));
  live::touch_stack();
}

/// Makes what is as large as the map; where that cannot be, says who wants it so large.
template <class Make>
auto with_room(const RunSetup& setup, Make make) {
  Faults faults{setup.why_places};
  try {
    return make();
  } catch (const SetupError& error) {
    faults.insert(faults.end(), error.faults().begin(), error.faults().end());
  } catch (const std::bad_alloc&) {
    faults.push_back({"memory", "there is not enough"});
  }
  throw SetupError(std::move(faults));
}

std::unique_ptr<Serving> open_serving(const RunSettings& settings, const RunSetup& setup,
                                      const RunConditions& conditions) {
  if (!settings.serve.address) return nullptr;
  nlohmann::ordered_json run = conditions_json(conditions);
  run["memory_planned"] = PlaceMap::bytes_needed(conditions.config, setup.capacity()) +
                          Detector::bytes_needed(conditions.config, setup.capacity());
  return std::make_unique<Serving>(settings.serve, std::move(run), setup.own_places,
                                   setup.map ? setup.map->pictures() : nullptr);
}

/// Ends a run that was asked to stop before its first frame: it has nothing to put into outputs.
void stop_before_the_first_frame(LastingMap* map) {
  if (interrupted() && map != nullptr) map->discard();
  stop_if_interrupted();
}

/// Does what people wish, before the next frame. @return whether the run goes on
bool heed(const Wishes& wishes, Detector& detector, Clock& clock, std::uint64_t frame,
          RunConditions& conditions) {
  constexpr auto pause = std::chrono::milliseconds(20);
  while (wishes.pause && !wishes.stop && !interrupted()) clock.sleep_until(clock.now() + pause);
  const float least = wishes.min_probability.load(std::memory_order_relaxed);
  auto& changes = conditions.changes;
  const float before =
      changes.empty() ? conditions.config.min_probability : changes.back().min_probability;
  if (least > 0.0F && least != before) {
    detector.accept_from(least);
    changes.push_back({frame, least});
  }
  return !wishes.stop && !interrupted();
}

}  // namespace

void run(const RunSettings& settings, Faults faults) {
  take_interruptions();
  live::SteadyClock clock;
  if (settings.serve.address) check(settings.serve, faults);
  RunSetup setup = set_up(settings, std::move(faults), clock);
  stop_if_interrupted();
  if (!setup.capture.empty()) say("{}: {}", settings.source.string(), setup.capture);

  RunConditions conditions{settings.source,
                           settings.reference,
                           settings.map.file,
                           settings.matcher.method,
                           setup.config,
                           setup.places,
                           setup.descriptor_size,
                           setup.budget,
                           setup.overload,
                           0,
                           setup.capture,
                           {},
                           {}};
  const std::unique_ptr<Serving> serving = open_serving(settings, setup, conditions);
  std::unique_ptr<RosAnswers> ros;
  if (settings.ros) {
    ros = std::make_unique<RosAnswers>(setup.ros, setup.stamp_ns, setup.own_places,
                                       setup.map ? setup.map->pictures() : nullptr);
  }

  // Start-up: the map, then every path once, before the first frame counts.
  live::TouchedMemory memory = with_room(setup, [&] {
    return live::TouchedMemory(PlaceMap::bytes_needed(setup.config, setup.capacity()));
  });
  live::TouchedMemory working_memory = with_room(setup, [&] {
    return live::TouchedMemory(Detector::bytes_needed(setup.config, setup.capacity()));
  });
  PlaceMap map(setup.config, setup.capacity(), memory.span(), true);
  opencv::expect_builtin(map);
  if (setup.reference) {
    Progress mapping("mapping", setup.reference->frame_count());
    const auto look = [&](const Frame& frame) {
      if (serving) serving->add_place(frame.image, frame.index);
      if (ros) ros->add_place(frame.image, frame.index);
    };
    const Mapped mapped =
        fill_map(map, *setup.reference, setup.describer.get(), setup.config, mapping, look);
    tell_notes(settings.reference, *setup.reference);
    tell_blank(settings.reference, mapped.blank, mapped.frames);
  }
  if (setup.map) setup.map->load(map);
  memory.wait();
  working_memory.wait();
  Detector detector(setup.config, map, working_memory.span());
  RunSummary summary(setup.budget, setup.paced);
  OverloadWatch overload(setup.overload);
  PictureRecorder recorder(setup.config.difference);
  std::vector<float> query(map.rows().restored_size());
  Progress progress("running", setup.frame_count(settings.frames));
  TroubleLog trouble(progress, setup.paced);
  std::unique_ptr<Fleet> fleet;
  if (!settings.fleet.name.empty()) {
    MatcherConfig config = setup.config;
    suit_slice(config, settings.matcher, settings.fleet.places);
    fleet = with_room(setup, [&] {
      return std::make_unique<Fleet>(settings.fleet, setup.ros, *setup.map, config, map);
    });
  }
  // A thread that saves is no part of the loop.
  const LastingMap::Saving saving =
      setup.map ? setup.map->begin(map, setup.config, settings.matcher.method) : nullptr;
  if (setup.map && serving) serving->keep_in(*setup.map);
  if (setup.map && ros) ros->keep_in(*setup.map);
  // Where places are numbered on, the drive's frames are from there.
  std::optional<std::uint64_t> first_place;
  if (setup.map && !settings.map.read_only) first_place = setup.map->sessions().back().first;
  become_real_time(settings.real_time);
  warm_up(setup.describer.get(), setup.config, setup.descriptor_size);
  start_playing(setup, settings, clock);
  Pipeline pipeline(setup.source(), setup.describer.get(), detector, clock, setup.descriptor_size);
  setup.out->heed(interrupted);
  stop_before_the_first_frame(setup.map.get());
  const live::ThreadCounters warm = live::thread_counters();

  SourceNumbers numbers = with_room(
      setup, [&] { return SourceNumbers(setup.config, setup.own_places ? &map : nullptr); });
  FrameLines::More of_others;
  if (fleet) of_others = [&fleet](nlohmann::ordered_json& frame) { fleet->add_to(frame); };
  FrameLines lines(*setup.out, setup.paced, setup.map.get(), of_others);
  std::uint64_t blank_frames = 0;
  std::uint64_t next_frame = 0;
  bool map_full = false;
  bool given_up = false;
  Attempts attempt;
  bool lines_whole = true;
  while (!interrupted() && (settings.frames == 0 || summary.frames() < settings.frames)) {
    if (serving && !heed(serving->watch().wishes, detector, clock, next_frame, conditions)) break;
    std::optional<ProcessedFrame> processed = pipeline.process();
    if (!processed) break;
    if (!settings.pictures.empty()) {
      detector.newest_query(query);
      recorder.add(processed->report.newest, query);
      recorder.add(processed->report.answers);
    }
    const std::span<const float> seen = processed->descriptor;
    const bool is_blank = !seen.empty() && blank(setup.config.difference, seen);
    if (setup.map && processed->report.gate != Gate::no_frame) {
      setup.map->note(detector, processed->report.newest, processed->frame.index,
                      processed->frame.time_s, processed->frame.image, processed->report.answers,
                      !seen.empty() && !is_blank);
      if (const auto trouble_saving = setup.map->trouble()) progress.tell(*trouble_saving);
    }
    if (fleet) {
      fleet->step(*processed, clock);
      if (const auto news = fleet->trouble()) progress.tell(*news);
    }
    std::optional<std::uint64_t> newest_place;
    if (first_place) newest_place = *first_place + processed->report.newest;
    numbers.rename(*processed);
    if (processed->report.gate != Gate::no_frame) next_frame = processed->report.newest + 1;
    if (setup.own_places) newest_place = processed->report.newest;
    const LoopState state{misses(processed->times, setup.budget), overload.overloaded()};
    summary.add(*processed, state);
    MapState kept{map.size(), setup.map ? setup.map->saved() : 0};
    if (fleet) kept.of_others = fleet->places();
    kept.newest = newest_place;
    if (serving) serving->watch().publish(*processed, state, summary, kept, clock.now());
    if (ros) ros->publish(*processed, state, summary, kept, clock.now());
    if (fleet && serving) serving->watch().publish(fleet->loops());
    if (fleet && ros) ros->publish(fleet->loops());
    if (is_blank) ++blank_frames;
    lines_whole = attempt([&] { lines.add(*processed, state); });
    if (!attempt([&] { setup.loops->add(*processed, newest_place); })) {
      progress.tell("the bag of loops cannot be written on, and is given up; the run goes on");
    }
    if (fleet) attempt([&] { setup.loops->add(fleet->loops()); });
    if (!lines_whole) break;
    trouble.tell(*processed, clock.now());
    if (processed->report.gate == Gate::no_frame) {
      given_up = settings.give_up_s > 0.0 &&
                 trouble.silence(clock.now()) > std::chrono::duration<double>(settings.give_up_s);
      if (given_up) break;
      continue;
    }
    if (processed->report.map_full && !std::exchange(map_full, true)) {
      progress.tell(fmt::format("frame {}: the map is full: from here on frames become no places",
                                processed->report.newest));
    }
    if (setup.live && overload.observe(state.missed.any())) {
      setup.live->take_every(overload.take_every());
      trouble.tell(overload, setup.overload);
    }
    progress.step();
  }
  if (summary.frames() == 0) stop_before_the_first_frame(setup.map.get());
  const ThreadCost cost = since(warm);
  progress.done();
  const std::span<const Answer> rest = detector.finish();
  recorder.add(rest);
  summary.add(rest);
  tell_notes(settings.source, setup.recording ? *setup.recording : setup.source());
  tell_blank(settings.source, blank_frames, summary.frames());
  const bool none_readable =
      summary.frames() > 0 && summary.frames() == summary.at(Gate::frame_error);
  if (none_readable && setup.recording) {
    if (setup.map) setup.map->discard();
    throw SetupError(
        {settings.source.string(), "none of its frames can be read or shows anything"});
  }
  if (fleet) fleet->finish(rest);
  std::optional<std::string> unsaved;
  if (setup.map) attempt([&] { unsaved = setup.map->finish(detector, rest); });
  const std::span<const Answer> last = numbers.rename(rest);
  if (serving) serving->watch().end(last, summary);
  if (ros) ros->publish(last);
  if (fleet && serving) serving->watch().publish(fleet->loops());
  if (fleet && ros) ros->publish(fleet->loops());
  // The answers first: a driver that hangs may keep the capture thread from ending.
  lines_whole = lines_whole && attempt([&] { lines.end(last); });
  attempt([&] { setup.loops->add(last); });
  if (fleet) attempt([&] { setup.loops->add(fleet->loops()); });
  if (fleet) {
    const std::string told = fleet->end();
    while (const auto news = fleet->trouble()) say("{}", *news);
    say("fleet '{}': {}", settings.fleet.name, told);
  }
  if (const std::uint64_t unsent = ros ? ros->end() : 0; unsent > 0) {
    say("dropped of what was to go to ROS 2: {}; subscribers, or this machine, were too slow",
        counted(unsent, "message"));
  }
  if (lines_whole) {
    attempt([&] { setup.out->commit(); });
  } else if (const auto kept = setup.out->keep_incomplete(); !kept.empty()) {
    say("what was written before is in {}", kept.string());
  }
  if (setup.live) {
    setup.live->stop();
    summary.captured(setup.live->counts());
  }
  if (setup.summary) {
    conditions.overloads = overload.episodes();
    conditions.cost = cost;
    attempt([&] {
      setup.summary->write(run_report(summary, conditions));
      setup.summary->commit();
    });
  }
  if (lines_whole && !settings.pictures.empty()) {
    write_pictures(settings, recorder, map, setup.map.get(), attempt);
  }
  say_raw("seqloop: " + summary.text());
  // Without its lines the run ended early: what it has would replace what is whole.
  if (lines_whole) {
    attempt([&] { setup.loops->end(); });
    for (const std::string& note : setup.loops->notes()) say("{}", note);
    setup.loops->commit(attempt);
  }
  if (setup.map && !unsaved) {
    while (const auto news = setup.map->trouble()) say("{}", *news);
  }
  if (setup.map) say("{}: {}", settings.map.file.string(), setup.map->summary());
  if (unsaved) attempt.fail(*unsaved);
  if (given_up) {
    attempt.fail(fmt::format("{}: no frame for {:g} seconds: given up", settings.source.string(),
                             settings.give_up_s));
  }
  if (none_readable) {
    attempt.fail(settings.source.string() +
                 ": none of its frames could be read or showed anything");
  }
  attempt.end();
}

}  // namespace seqloop::program
