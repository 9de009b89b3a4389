// SPDX-License-Identifier: MIT
#include "program/bench/bench.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "program/bench/contender.hpp"
#include "program/bench/describe_bench.hpp"
#include "program/bench/fastest_read.hpp"
#include "program/bench/open_bench.hpp"
#include "program/bench/search_bench.hpp"
#include "program/bench/step_bench.hpp"
#include "program/drives/drives.hpp"
#include "program/options/flag_names.hpp"
#include "program/options/verb.hpp"
#include "program/process/build_info.hpp"
#include "program/process/say.hpp"
#include "seqloop/latency_histogram.hpp"
#include "seqloop/opencv/threads.hpp"

namespace seqloop::program {
namespace {

struct BenchSettings {
  bool json = false;
  std::string only;
  std::vector<std::size_t> places{3476};
  std::size_t descriptor_size = 735;
  std::size_t ds = 100;
  double relocalise_s = 0.2;
  std::size_t rounds = 200;
  std::size_t graph_places = 20'000;
  DriveSettings drive;
};

constexpr std::array whats{"describe", "step", "search", "column",
                           "matrix",   "loop", "memory", "open"};

// Products of two drives: beyond these they take minutes.
constexpr std::size_t most_matrix_places = 20'000;

std::string all_whats() { return fmt::format("{}", fmt::join(whats, ", ")); }

std::vector<std::size_t> parse_counts(std::string_view text) {
  std::vector<std::size_t> counts;
  while (true) {
    const std::size_t comma = text.find(',');
    counts.push_back(parse_count(text.substr(0, comma)));
    if (comma == std::string_view::npos) return counts;
    text.remove_prefix(comma + 1);
  }
}

double microseconds(Nanoseconds duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

std::vector<Contender> timed(const BenchSettings& settings, const Peers& peers) {
  const auto asked = [&](std::string_view what) {
    if (settings.only.empty()) return what == "describe" || what == "step";
    return settings.only == what;
  };
  std::vector<Contender> all;
  if (asked("describe")) time_describing(settings.drive, settings.rounds, all);
  if (asked("memory")) time_memory(settings.rounds, all);
  for (const std::size_t places : settings.places) {
    const Capacity size{places, settings.descriptor_size};
    if (asked("column")) {
      time_columns(size, settings.graph_places, peers.columns, settings.rounds, all);
    }
    if (asked("search")) time_search(places, settings.ds, settings.rounds, all);
    if (asked("step")) time_steps(size, settings.ds, settings.relocalise_s, settings.rounds, all);
    if (asked("open")) time_opening(size, settings.rounds, all);
    if (asked("loop")) time_loop(places, settings.ds, settings.relocalise_s, settings.rounds, all);
    if (asked("matrix")) {
      if (places > most_matrix_places) {
        say("matrix: left out for {} places, more than {}", places, most_matrix_places);
      } else {
        time_matrix(size, settings.ds, peers.matrices, settings.rounds, all);
      }
    }
  }
  return all;
}

void bench(const BenchSettings& settings, const Peers& peers, Faults faults) {
  if (!settings.only.empty() && std::ranges::find(whats, settings.only) == whats.end()) {
    faults.push_back({"only", "'" + settings.only + "' is not timed", all_whats()});
  }
  if (!(settings.relocalise_s > 0.0)) faults.push_back({"relocalise-s", "it must be above 0"});
  if (!settings.only.empty() && settings.only != "describe") {
    refuse_describing(settings.drive, "describing is not timed", faults);
  }
  check_reading(settings.drive, settings.drive.training, faults);
  if (settings.rounds == 0) faults.push_back({"rounds", "0 is not above 0"});
  if (settings.only != "describe" && settings.only != "memory") {
    MatcherConfig config;
    config.sequence_length = settings.ds;
    for (Fault& fault : validate(config)) faults.push_back(std::move(fault));
    for (const std::size_t places : settings.places) {
      for (Fault& fault : validate(Capacity{places, settings.descriptor_size}, config)) {
        fault = in_flags(std::move(fault));
        if (fault.what == "max-places") fault.what = "n";
        if (fault.what == "descriptor-size") fault.what = "d";
        faults.push_back(std::move(fault));
      }
    }
  }
  refuse(std::move(faults));
  opencv::use_threads(1);
  say("{}; bench --only {} --n {} --d {} --ds {} --rounds {}", condition_line(),
      settings.only.empty() ? "[describe and step]" : settings.only,
      fmt::join(settings.places, ","), settings.descriptor_size, settings.ds, settings.rounds);
  const std::vector<Contender> all = timed(settings, peers);
  if (!settings.json) fmt::print("{:>85} {:>10} {:>10} {:>10}\n", "p50", "p99", "p99.9", "max");

  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Contender& row : all) {
    const LatencyHistogram& times = row.times;
    rows.push_back({{"what", row.what},
                    {"by", row.by},
                    {"n", row.places},
                    {"d", row.descriptor_size},
                    {"ds", settings.ds},
                    {"p50_us", microseconds(times.quantile(0.5))},
                    {"p99_us", microseconds(times.quantile(0.99))},
                    {"p999_us", microseconds(times.quantile(0.999))},
                    {"max_us", microseconds(times.maximum())},
                    {"rounds", times.count()},
                    {"bytes", row.bytes}});
    if (settings.json) continue;
    fmt::print("{:<9}{:<32}{:>8} places{:>6} values {:>10.1f} {:>10.1f} {:>10.1f} {:>10.1f} us\n",
               row.what, row.by, row.places, row.descriptor_size, microseconds(times.quantile(0.5)),
               microseconds(times.quantile(0.99)), microseconds(times.quantile(0.999)),
               microseconds(times.maximum()));
  }
  if (settings.json) fmt::print("{}\n", rows.dump(1));
}

}  // namespace

Verb bench_verb(const Peers& peers) {
  const auto settings = std::make_shared<BenchSettings>();
  Verb verb{
      "bench",
      "Time describing (beside --descriptor or --model), steps and their parts here, on one thread",
      {},
      [settings, peers](Faults faults) { bench(*settings, peers, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.flag("json", settings->json, "print JSON");
  verb.options.text("only", settings->only, all_whats() + " [describe and step]");
  verb.options.add({"n", ValueKind::text, "places of the map, several with commas between [3476]",
                    [settings](std::string_view text) { settings->places = parse_counts(text); }});
  verb.options.count("d", settings->descriptor_size,
                     "values in a descriptor, for step, column and matrix [735]");
  verb.options.count("ds", settings->ds, "sequence length [100]");
  verb.options.number("relocalise-s", settings->relocalise_s,
                      "seconds of driving in which relocalising looks at all places [0.2]");
  verb.options.count("rounds", settings->rounds,
                     "times that each is timed, or as often as 20 s allow [200]");
  if (peers.columns) {
    verb.options.count("graph-places", settings->graph_places,
                       "places up to which FAISS's HNSW is built, which takes long [20000]");
  }
  add_drive_options(verb.options, settings->drive);
  return verb;
}

}  // namespace seqloop::program
