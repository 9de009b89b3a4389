// SPDX-License-Identifier: MIT
#include "program/watch/metrics.hpp"

#include <fmt/format.h>

#include <chrono>

namespace seqloop::program {
namespace {

/// The text as it grows, a family after the other.
class Text {
 public:
  void family(const char* name, const char* type, const char* help) {
    name_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
  }
  template <class Value>
  void value(Value value, std::string_view labels = {}) {
    line("", labels, value);
  }
  template <class Value>
  void line(const char* ending, std::string_view labels, Value value) {
    text_ += labels.empty() ? fmt::format("{}{} {}\n", name_, ending, value)
                            : fmt::format("{}{}{{{}}} {}\n", name_, ending, labels, value);
  }
  template <class Value>
  void one(const char* name, const char* type, const char* help, Value only) {
    family(name, type, help);
    value(only);
  }
  [[nodiscard]] std::string done() && { return std::move(text_); }

 private:
  const char* name_ = "";
  std::string text_;
};

double seconds(Nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

void add_stages(Text& text, const RunCounts& counts) {
  text.family("seqloop_stage_seconds", "histogram", "How long a stage of a frame took.");
  for (std::size_t i = 0; i < stage_names.size(); ++i) {
    const StageCounts& stage = counts.stages[i];
    std::uint64_t so_far = 0;
    for (std::size_t bucket = 0; bucket < bucket_ms.size(); ++bucket) {
      so_far += stage.in[bucket];
      text.line("_bucket",
                fmt::format("stage=\"{}\",le=\"{:g}\"", stage_names[i], bucket_ms[bucket] / 1e3),
                so_far);
    }
    so_far += stage.in.back();
    text.line("_bucket", fmt::format("stage=\"{}\",le=\"+Inf\"", stage_names[i]), so_far);
    text.line("_sum", fmt::format("stage=\"{}\"", stage_names[i]), seconds(stage.sum));
    text.line("_count", fmt::format("stage=\"{}\"", stage_names[i]), so_far);
  }
}

}  // namespace

std::string metrics(const Snapshot& snapshot, const MonitorFacts& facts) {
  const RunCounts& counts = snapshot.counts;
  Text text;
  text.family("seqloop_build_info", "gauge", "Which program this is; always 1.");
  text.value(1, fmt::format("version=\"{}\"", facts.version));
  text.one("seqloop_healthy", "gauge", "1 while frames come and the budget holds, otherwise 0.",
           facts.healthy ? 1 : 0);
  text.one("seqloop_frames_total", "counter", "Frames that were taken up.", counts.frames);
  // A count of `warming_up` falls when a frame gets its answer: it is no counter.
  text.family("seqloop_answers", "gauge", "Frames by the status of their answers.");
  for (std::size_t gate = 0; gate < gates; ++gate) {
    text.value(counts.at[gate], fmt::format("status=\"{}\"", name(static_cast<Gate>(gate))));
  }
  text.one("seqloop_matches_total", "counter", "Frames whose place was recognised.",
           counts.at[static_cast<std::size_t>(Gate::match)]);
  text.one("seqloop_deadline_missed_total", "counter", "Frames that broke a limit of the budget.",
           counts.misses);
  text.family("seqloop_limit_missed_total", "counter",
              "Frames that broke each limit of the budget.");
  constexpr std::array limits{"age", "describe", "grab", "match", "total"};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    text.value(counts.missed[i], fmt::format("limit=\"{}\"", limits[i]));
  }
  text.one("seqloop_dropped_total", "counter", "Frames that were dropped for newer ones.",
           counts.dropped);
  text.one("seqloop_lost_total", "counter", "Frames that the camera never delivered.", counts.lost);
  text.one("seqloop_overloaded_total", "counter", "Frames under the overload policy.",
           counts.overloaded);
  text.one("seqloop_overloaded", "gauge", "1 while the overload policy is in force.",
           snapshot.state.overloaded ? 1 : 0);
  add_stages(text, counts);
  const auto& now = snapshot.frame.report.now;
  text.one("seqloop_now_probability", "gauge", "That the newest frame is at its likeliest place.",
           now ? static_cast<double>(now->probability) : 0.0);
  text.one("seqloop_places", "gauge", "Places in the map.", snapshot.map.places);
  text.one("seqloop_saved_frames", "gauge",
           "Frames of the drive that are on the disk for good; 0 where the map is in no file.",
           snapshot.map.saved);
  text.one("seqloop_places_room", "gauge", "Places that the map has room for.", facts.places_room);
  text.one("seqloop_rows_scanned", "gauge", "Rows of the map scanned at the newest frame.",
           snapshot.frame.report.work.scanned);
  text.one("seqloop_memory_planned_bytes", "gauge", "Memory of map and matcher.",
           facts.memory_planned);
  text.one("seqloop_memory_used_bytes", "gauge", "Resident memory of the program.",
           facts.memory_used);
  text.one("seqloop_unseen_total", "counter", "Frames and answers that were not shown.",
           facts.unseen);
  text.one("seqloop_connections", "gauge", "Connections to this server.", facts.connections);
  text.one("seqloop_sent_bytes_total", "counter", "Bytes sent over connections that are closed.",
           facts.bytes_sent);
  return std::move(text).done();
}

}  // namespace seqloop::program
