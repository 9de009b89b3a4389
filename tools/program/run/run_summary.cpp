// SPDX-License-Identifier: MIT
#include "program/run/run_summary.hpp"

#include <fmt/format.h>

#include <chrono>
#include <numeric>

#include "program/process/milliseconds.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

Nanoseconds limit_of(const Budget& budget, std::string_view name) {
  if (name == "age") return budget.age;
  if (name == "grab") return budget.grab;
  if (name == "describe") return budget.describe;
  return name == "match" ? budget.match : budget.total;
}

std::string stage_line(const StageRecord& stage) {
  return fmt::format(
      "  {:<10}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}\n", stage.name,
      milliseconds(stage.times.quantile(0.5)), milliseconds(stage.times.quantile(0.99)),
      milliseconds(stage.times.quantile(0.999)), milliseconds(stage.times.maximum()));
}

std::size_t index(Gate gate) { return static_cast<std::size_t>(gate); }

}  // namespace

void RunSummary::add(const ProcessedFrame& processed, const LoopState& state) {
  const FrameReport& report = processed.report;
  add(report.answers);
  // A frame that cannot be read may come before any is answered.
  const bool unanswered = report.answers.empty() && report.gate == Gate::frame_error;
  if (unanswered || report.gate == Gate::no_frame) ++at_gate_[index(report.gate)];
  if (report.gate == Gate::no_frame) return;
  const StageTimes& times = processed.times;
  stages_[grab].times.add(times.grab);
  stages_[describe].times.add(times.describe);
  stages_[match].times.add(times.match);
  stages_[total].times.add(times.total);
  stages_[age].times.add(times.age);
  stages_[answer].times.add(times.age + times.total);
  dropped_ += processed.frame.dropped;
  lost_ += processed.frame.lost;
  if (report.map_full) ++map_full_;
  if (state.missed.any()) ++misses_;
  for (const std::string_view limit : names(state.missed)) ++missed_.at(limit);
  if (state.overloaded) ++overloaded_;
}

void RunSummary::add(std::span<const Answer> answers) {
  for (const Answer& given : answers) ++at_gate_[index(given.gate)];
}

std::uint64_t RunSummary::at(Gate gate) const noexcept {
  if (gate != Gate::warming_up) return at_gate_[index(gate)];
  const std::uint64_t events = at_gate_[index(Gate::no_frame)];
  return frames() + events - std::accumulate(at_gate_.begin(), at_gate_.end(), std::uint64_t{0});
}

std::string RunSummary::text() const {
  std::string text = fmt::format("{}: {} match", counted(frames(), "frame"), at(Gate::match));
  for (std::size_t i = index(Gate::match); i-- > index(Gate::frame_error);) {
    const auto gate = static_cast<Gate>(i);
    if (at(gate) > 0) text += fmt::format(", {} {}", at(gate), name(gate));
  }
  text += '\n';
  if (frames() > 0) {
    text += fmt::format("  {:<10}{:>10}{:>10}{:>10}{:>10}\n", "ms", "p50", "p99", "p99.9", "max");
    for (const StageRecord& stage : stages()) text += stage_line(stage);
  }
  text += fmt::format("  {} missed the budget", counted(misses_, "frame"));
  for (const auto& [limit, frames] : missed_) {
    if (frames > 0 || limit == "total") {
      text += fmt::format(", {} that of {:g} ms for {}", frames,
                          milliseconds(limit_of(budget_, limit)), limit);
    }
  }
  if (capture_) {
    text += fmt::format("\n  {} grabbed: {} taken, {} dropped; {} lost\n", capture_->delivered,
                        frames(), capture_->dropped, capture_->lost);
  } else {
    text += ", 0 dropped\n";
  }
  if (at(Gate::no_frame) > 0) {
    text += fmt::format("  {} no frame came in time\n", counted(at(Gate::no_frame), "time"));
  }
  if (overloaded_ > 0) {
    text += fmt::format("  {} under the overload policy\n", counted(overloaded_, "frame"));
  }
  if (map_full_ > 0) {
    text += fmt::format("  the map was full: {} became no place{}; raise --max-places\n",
                        counted(map_full_, "frame"), map_full_ == 1 ? "" : "s");
  }
  return text;
}

}  // namespace seqloop::program
