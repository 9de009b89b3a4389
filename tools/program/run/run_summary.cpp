// SPDX-License-Identifier: MIT
#include "program/run/run_summary.hpp"

#include <fmt/format.h>

#include <chrono>

namespace seqloop::program {
namespace {

double milliseconds(Nanoseconds duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

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

}  // namespace

void RunSummary::add(const ProcessedFrame& processed, const LoopState& state) {
  ++at_gate_[static_cast<std::size_t>(processed.report.gate)];
  if (processed.report.gate == Gate::no_frame) return;
  const StageTimes& times = processed.times;
  stages_[grab].times.add(times.grab);
  stages_[describe].times.add(times.describe);
  stages_[match].times.add(times.match);
  stages_[total].times.add(times.total);
  stages_[age].times.add(times.age);
  stages_[answer].times.add(times.age + times.total);
  dropped_ += processed.frame.dropped;
  lost_ += processed.frame.lost;
  if (processed.report.map_full) ++map_full_;
  if (state.missed.any()) ++misses_;
  for (const std::string_view limit : names(state.missed)) ++missed_.at(limit);
  if (state.overloaded) ++overloaded_;
}

std::string RunSummary::text() const {
  std::string text = fmt::format("{} frames:", frames());
  const auto first = static_cast<std::size_t>(Gate::frame_error);
  for (std::size_t gate = gates; gate-- > first;) {
    text += fmt::format(" {} {}{}", at_gate_[gate], name(static_cast<Gate>(gate)),
                        gate > first ? "," : "\n");
  }
  if (frames() > 0) {
    text += fmt::format("  {:<10}{:>10}{:>10}{:>10}{:>10}\n", "ms", "p50", "p99", "p99.9", "max");
    for (const StageRecord& stage : stages()) text += stage_line(stage);
  }
  text += fmt::format("  {} frames missed the budget", misses_);
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
    text += fmt::format("  {} times no frame came in time\n", at(Gate::no_frame));
  }
  if (overloaded_ > 0) {
    text += fmt::format("  {} frames under the overload policy\n", overloaded_);
  }
  if (map_full_ > 0) {
    text += fmt::format("  the map was full: {} frames became no places; raise --max-places\n",
                        map_full_);
  }
  return text;
}

}  // namespace seqloop::program
