#include "seqloop/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace seqloop::program {
namespace {

double milliseconds(Nanoseconds duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

std::string stage_line(const char* stage, const LatencyHistogram& times) {
  return fmt::format("  {:<10}{:>10.3f}{:>10.3f}{:>10.3f}\n", stage,
                     milliseconds(times.quantile(0.5)), milliseconds(times.quantile(0.99)),
                     milliseconds(times.maximum()));
}

}  // namespace

bool RunSummary::add(const ProcessedFrame& processed) {
  const StageTimes& times = processed.times;
  grab_.add(times.grab);
  describe_.add(times.describe);
  match_.add(times.match);
  total_.add(times.total);
  latest_ = std::max(latest_, times.late);
  ++at_gate_[static_cast<std::size_t>(processed.report.gate)];
  if (processed.report.map_full) ++map_full_;
  const bool missed = times.total > budget_;
  if (missed) ++misses_;
  return missed;
}

std::uint64_t RunSummary::errors() const noexcept {
  return at_gate_[static_cast<std::size_t>(Gate::frame_error)];
}

std::string RunSummary::text() const {
  std::string text = fmt::format("{} frames:", frames());
  for (std::size_t gate = gates; gate-- > 0;) {
    text += fmt::format(" {} {}{}", at_gate_[gate], name(static_cast<Gate>(gate)),
                        gate > 0 ? "," : "\n");
  }
  text += fmt::format("  {:<10}{:>10}{:>10}{:>10}\n", "ms", "p50", "p99", "max");
  text += stage_line("grab", grab_) + stage_line("describe", describe_) +
          stage_line("match", match_) + stage_line("total", total_);
  text += fmt::format("  {} frames missed the budget of {:g} ms, 0 dropped\n", misses_,
                      milliseconds(budget_));
  if (latest_ > Nanoseconds(0)) {
    text += fmt::format("  grabbed up to {:.1f} ms after their time\n", milliseconds(latest_));
  }
  if (map_full_ > 0) {
    text += fmt::format("  the map was full: {} frames became no places; raise --max-places\n",
                        map_full_);
  }
  return text;
}

}  // namespace seqloop::program
