#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "opencv/builtin_describer.hpp"
#include "opencv/threads.hpp"
#include "seqloop/bench.hpp"
#include "seqloop/build_info.hpp"
#include "seqloop/column_bench.hpp"
#include "seqloop/contender.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/drives.hpp"
#include "seqloop/fastest_read.hpp"
#include "seqloop/latency_histogram.hpp"
#include "seqloop/say.hpp"
#include "seqloop/verb.hpp"

namespace seqloop::program {
namespace {

struct BenchSettings {
  bool json = false;
  std::string only;
  std::vector<std::size_t> places{3476};
  std::size_t descriptor_size = 735;
  std::size_t ds = 100;
  std::size_t rounds = 200;
  DriveSettings drive;
};

/// A picture with edges in all directions. What is in it does not change what it costs.
std::vector<std::uint8_t> made_picture(int width, int height) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double wave = std::sin(0.05 * x + 0.0004 * x * y) + std::sin(0.07 * y);
      for (int channel = 0; channel < 3; ++channel) {
        pixels.push_back(static_cast<std::uint8_t>(128.0 + 50.0 * wave + 5.0 * channel));
      }
    }
  }
  return pixels;
}

/// Of what is asked for beside the built-in descriptor; empty when nothing is.
std::string name_of(const DriveSettings& drive) {
  const opencv::ModelSettings& model = drive.model;
  std::string name = model.model.empty() ? drive.descriptor
                                         : model.model.stem().string() +
                                               (model.layer.empty() ? "" : ":" + model.layer);
  if (drive.remove_components) {
    if (name.empty()) name = "gradients";
    name += fmt::format(" less {} components", *drive.remove_components);
  }
  return name;
}

/// The built-in descriptor, and what is asked for beside it, from a 640x480 colour frame.
void time_describing(const BenchSettings& settings, std::vector<Contender>& all) {
  constexpr int width = 640;
  constexpr int height = 480;
  const std::vector<std::uint8_t> pixels = made_picture(width, height);
  const Image image{pixels.data(), width, height, std::size_t{width} * 3, PixelFormat::bgr8};
  std::vector<std::pair<std::string, std::unique_ptr<Describer>>> describers;
  describers.emplace_back("seqloop-built-in", opencv::make_builtin_describer());
  const std::string other = name_of(settings.drive);
  if (!other.empty()) describers.emplace_back(other, open_describer(settings.drive));
  std::vector<Contender> contenders;
  std::vector<std::vector<float>> outputs;
  outputs.reserve(describers.size());
  for (const auto& [name, describer] : describers) {
    std::vector<float>& output = outputs.emplace_back(describer->size());
    contenders.push_back({"describe", name, 0, describer->size(), pixels.size(),
                          [&image, &output, worker = describer.get()] {
                            if (worker->describe(image, output) == Description::failed) {
                              throw std::runtime_error("describe: " +
                                                       std::string(worker->last_fault()));
                            }
                          }});
  }
  time_in_turn(std::move(contenders), settings.rounds, all);
}

/// A whole step of exhaustive search: one column of differences, every line through every row.
void time_steps(const BenchSettings& settings, std::size_t places, std::vector<Contender>& all) {
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.sequence_length = settings.ds;
  config.standardisation.on = false;
  const Capacity capacity{places, settings.descriptor_size};
  Faults faults = validate(config);
  for (Fault& fault : validate(capacity)) faults.push_back(std::move(fault));
  refuse(std::move(faults));

  std::mt19937 random(1);
  PlaceMap map(config, capacity);
  while (map.add(random_unit(random, capacity.descriptor_size))) {
  }
  Detector detector(config, map);
  const std::vector<float> query = random_unit(random, capacity.descriptor_size);
  for (std::size_t frame = 0; frame <= settings.ds; ++frame) (void)detector.step(query);
  std::vector<Contender> contenders;
  contenders.push_back({"step", "seqloop-float", places, capacity.descriptor_size,
                        capacity.places * padded_size(capacity.descriptor_size) * sizeof(float),
                        [&] { (void)detector.step(query); }});
  time_in_turn(std::move(contenders), settings.rounds, all);
}

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

void bench(const BenchSettings& settings, const RivalColumns& rivals, Faults faults) {
  const std::string& only = settings.only;
  if (!only.empty() && only != "describe" && only != "step" && only != "column" &&
      only != "memory") {
    faults.push_back({"only", "'" + only + "' is not timed", "describe, step, column or memory"});
  }
  if (settings.rounds == 0) faults.push_back({"rounds", "0 is not above 0"});
  for (const std::size_t places : settings.places) {
    if (only == "describe" || only == "memory") break;
    for (Fault& fault : validate(Capacity{places, settings.descriptor_size})) {
      faults.push_back(std::move(fault));
    }
  }
  refuse(std::move(faults));
  opencv::use_threads(1);
  say("{}", condition_line());
  std::vector<Contender> all;
  if (only.empty() || only == "describe") time_describing(settings, all);
  if (only == "memory") time_memory(settings.rounds, all);
  for (const std::size_t places : settings.places) {
    if (only == "column") {
      time_columns({places, settings.descriptor_size}, rivals, settings.rounds, all);
    }
    if (only.empty() || only == "step") time_steps(settings, places, all);
  }

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
                    {"bytes", row.bytes}});
    if (settings.json) continue;
    fmt::print("{:<10}{:<40}{:>8} places{:>8} values{:>10.1f} us p50{:>10.1f} us p99\n", row.what,
               row.by, row.places, row.descriptor_size, microseconds(times.quantile(0.5)),
               microseconds(times.quantile(0.99)));
  }
  if (settings.json) fmt::print("{}\n", rows.dump(1));
}

}  // namespace

Verb bench_verb() { return bench_verb({}); }

Verb bench_verb(RivalColumns rivals) {
  const auto settings = std::make_shared<BenchSettings>();
  Verb verb{
      "bench",
      "Time describing (beside --descriptor or --model), a step or columns here, on one thread",
      {},
      [settings, rivals = std::move(rivals)](Faults faults) {
        bench(*settings, rivals, std::move(faults));
      }};
  verb.options.flag("json", settings->json, "print JSON");
  verb.options.text("only", settings->only, "describe, step, column or memory [describe and step]");
  verb.options.add({"n", ValueKind::text, "places of the map, several with commas between [3476]",
                    [settings](std::string_view text) { settings->places = parse_counts(text); }});
  verb.options.count("d", settings->descriptor_size,
                     "values in a descriptor, for step and column [735]");
  verb.options.count("ds", settings->ds, "sequence length [100]");
  verb.options.count("rounds", settings->rounds, "times that each is timed [200]");
  add_drive_options(verb.options, settings->drive);
  return verb;
}

}  // namespace seqloop::program
