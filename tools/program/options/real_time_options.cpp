// SPDX-License-Identifier: MIT
#include "program/options/real_time_options.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <utility>

namespace seqloop::program {
namespace {

constexpr std::size_t highest_priority = 98;  // 99 is left to the capture thread

std::vector<unsigned> parse_cpus(std::string_view text) {
  constexpr std::size_t most = 4095;
  std::vector<unsigned> cpus;
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    const std::size_t cpu = parse_count(text.substr(0, end));
    if (cpu > most) throw std::invalid_argument("no machine has a CPU " + std::to_string(cpu));
    cpus.push_back(static_cast<unsigned>(cpu));
    if (end == text.size()) return cpus;
    text.remove_prefix(end + 1);
  }
}

void append(Faults& faults, Faults more) { std::ranges::move(more, std::back_inserter(faults)); }

}  // namespace

live::ThreadSettings RealTimeSettings::work_thread() const {
  return {static_cast<int>(priority), cpus};
}

live::ThreadSettings RealTimeSettings::capture_thread() const {
  return {priority > 0 ? static_cast<int>(priority) + 1 : 0, cpus};
}

void add_real_time_options(OptionTable& options, RealTimeSettings& settings) {
  options.section("Real time");
  options.add({"realtime-priority", ValueKind::count,
               "SCHED_FIFO priority of a live loop, 1 to 98; its capture thread gets one more [0: "
               "ordinary scheduling]",
               [&settings](std::string_view value) {
                 const std::size_t priority = parse_count(value);
                 if (priority > highest_priority) throw std::invalid_argument("it must be 0 to 98");
                 settings.priority = priority;
               }});
  options.add({"realtime-cpus", ValueKind::text,
               "CPUs that a live loop may run on, from 0, with commas between [any]",
               [&settings](std::string_view value) { settings.cpus = parse_cpus(value); }});
  options.on_off("realtime-lock-memory", settings.lock_memory,
                 "keep all memory from being swapped out, and freed memory at hand [off]");
}

void prepare(const RealTimeSettings& settings, Faults& faults) {
  Faults found = live::validate(settings.work_thread(), "loop");
  // What is wrong by itself is told already; whether the system grants the rest is another
  // question.
  RealTimeSettings tried = settings;
  if (!found.empty()) tried.cpus.clear();
  append(faults, std::move(found));
  std::thread([&] {
    Faults refused = live::schedule(tried.work_thread(), "loop");
    if (refused.empty()) refused = live::schedule(tried.capture_thread(), "capture thread");
    append(faults, std::move(refused));
  }).join();
  if (!settings.lock_memory) return;
  append(faults, live::lock_memory());
  append(faults, live::keep_freed_memory());
}

}  // namespace seqloop::program
