// SPDX-License-Identifier: MIT
#include "program/run/loop_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "files/text_file.hpp"
#include "program/options/verb.hpp"
#include "program/run/closure.hpp"
#include "program/run/odometry.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {

namespace {

/// Adds to an output. What could not be added is missing in it: it is given up.
template <class Output, class Part>
void add_to(std::unique_ptr<Output>& output, Part part) {
  if (!output) return;
  try {
    part(*output);
  } catch (...) {
    output.reset();
    throw;
  }
}

}  // namespace

void add_loop_output_options(OptionTable& options, LoopOutputSettings& settings) {
  options.path("out-bag", Access::writes, settings.bag,
               "accepted loop closures as a bag of ROS 2 (.mcap) [none]");
  options.section("Pose graph", Shown::in_help_all);
  options.add(
      {"odometry", ValueKind::text,
       "where the robot believed to be: a file of poses (TUM), a topic of the source's bag or, "
       "of a live source, of ROS 2 [none]",
       [&settings](std::string_view value) { settings.odometry = value; },
       [&settings] {
         return std::vector<FileUse>{{"odometry", Access::reads, settings.odometry}};
       }});
  options.path("pose-graph", Access::writes, settings.pose_graph,
               "odometry and loops for an optimiser (.g2o) [none]");
  options.path("trajectory", Access::writes, settings.trajectory,
               "the frames' poses by odometry (TUM) [none]");
}

LoopOutputs::LoopOutputs(const LoopOutputSettings& settings, bool closing, Faults& faults) {
  const bool wants_graph = !settings.pose_graph.empty() || !settings.trajectory.empty();
  if (!settings.pose_graph.empty() && !closing) {
    faults.push_back({"pose-graph", "the poses of the reference are not known",
                      "leave --reference and --read-only out: loops are closed within the drive"});
  }
  if (wants_graph && settings.odometry.empty()) {
    faults.push_back({settings.pose_graph.empty() ? "trajectory" : "pose-graph",
                      "one camera does not tell how far it is from place to place",
                      "--odometry FILE or TOPIC"});
  }
  if (!wants_graph && !settings.odometry.empty()) {
    faults.push_back({"odometry", "nothing is made of it", "add --pose-graph FILE.g2o"});
  } else if (!settings.odometry.empty() && !listens_to_odometry(settings, true)) {
    // It can be no topic. When its times begin, the drive says later.
    collect(faults, [&] {
      static_cast<void>(parse_tum(files::read_text(settings.odometry), settings.odometry, 0.0));
    });
  }
  if (!settings.bag.empty()) {
    collect(faults, [&] { bag_ = std::make_unique<ClosuresBag>(settings.bag); });
  }
  if (wants_graph) {
    collect(faults, [&] {
      graph_ = std::make_unique<PoseGraph>(settings.pose_graph, settings.trajectory);
    });
  }
}

bool listens_to_odometry(const LoopOutputSettings& settings, bool live) {
  std::error_code error;
  return live && settings.odometry.starts_with('/') &&
         !std::filesystem::exists(settings.odometry, error);
}

void LoopOutputs::begin(const LoopOutputSettings& settings, LoopDrive drive) {
  drive_ = std::move(drive);
  if (!graph_) return;
  if (drive_.odometry) {
    topic_ = settings.odometry;
    return;
  }
  if (drive_.recording == nullptr) {
    throw SetupError({"odometry", "a camera's cannot be read from a file while it drives",
                      "give a topic of ROS 2, or record the drive and give the bag as --source"});
  }
  const std::int64_t start = drive_.start_ns();
  graph_->begin(read_odometry(settings.odometry, drive_.source, start),
                static_cast<double>(start) * 1e-9, drive_.sequence);
}

void LoopOutputs::add(const ProcessedFrame& processed, std::optional<std::uint64_t> place) {
  if (!bag_ && !graph_) return;
  const FrameReport& report = processed.report;
  if (report.gate != Gate::no_frame) {
    times_.add({report.newest, processed.frame.time_s, place});
    if (graph_ && topic_.empty()) graph_->add(report.newest, processed.frame.time_s);
  }
  add(report.answers);
}

void LoopOutputs::add(std::span<const Answer> answers) {
  if (graph_) add_to_graph(answers);
  add_to(bag_, [&](ClosuresBag& bag) { bag.add(answers, times_, drive_.stamp_ns, drive_.map); });
}

void LoopOutputs::add_to_graph(std::span<const Answer> answers) {
  for (const Answer& answer : answers) {
    if (!closes_loop(answer)) continue;
    const std::uint64_t place = answer.match->place;
    const FrameTimes::Entry* const near = times_.nearest(place);
    if (near == nullptr) {
      ++of_earlier_;
      continue;
    }
    const auto [less, more] = std::minmax(*near->place, place);
    if (more - less > PoseGraph::loop_frames) {
      ++of_unseen_;
      continue;
    }
    loops_.push_back(answer);
    loops_.back().match->place = near->frame;
  }
  if (topic_.empty()) graph_->add(std::exchange(loops_, {}));
}

void LoopOutputs::add(std::span<const OtherLoop> loops) {
  of_others_ += loops.size();
  add_to(bag_, [&](ClosuresBag& bag) { bag.add(loops, times_, drive_.stamp_ns); });
}

void LoopOutputs::end() {
  if (topic_.empty()) return;
  add_to(graph_, [&](PoseGraph& graph) {
    const std::int64_t start = drive_.start_ns();
    graph.begin(odometry_of(drive_.odometry(), topic_, start, SetBack::begins_anew),
                static_cast<double>(start) * 1e-9, drive_.sequence);
    for (const FrameTimes::Entry& entry : times_.all()) graph.add(entry.frame, entry.time_s);
    graph.add(loops_);
  });
}

std::vector<std::string> LoopOutputs::notes() const {
  if (!graph_) return {};
  std::vector<std::string> lines = graph_->notes();
  const auto leave_out = [&lines](std::uint64_t loops, const char* whose) {
    if (loops == 0) return;
    lines.push_back(fmt::format("{} with places of {} {} left out of it: their poses are not known",
                                counted(loops, "loop"), whose, are(loops)));
  };
  leave_out(of_earlier_, "earlier sessions");
  leave_out(of_others_, "other robots");
  leave_out(of_unseen_, "frames that never came");
  return lines;
}

void LoopOutputs::commit(Attempts& attempt) {
  if (bag_) attempt([this] { bag_->commit(); });
  if (graph_) graph_->commit(attempt);
}

}  // namespace seqloop::program
