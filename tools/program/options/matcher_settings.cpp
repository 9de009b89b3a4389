// SPDX-License-Identifier: MIT
#include "program/options/matcher_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "program/options/flag_names.hpp"

namespace seqloop::program {
namespace {

struct Method {
  std::string name;
  Candidates candidates;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all{{"seqslam", Candidates::all},
                                       {"seqcnnslam", Candidates::all},
                                       {"a-seqcnnslam", Candidates::ranges},
                                       {"o-seqcnnslam", Candidates::adaptive},
                                       {"single", Candidates::all}};
  return all;
}

void resolve_method(const std::string& name, MatcherConfig& config, Faults& faults) {
  const auto method = std::ranges::find(methods(), name, &Method::name);
  if (method != methods().end()) {
    config.candidates = method->candidates;
    return;
  }
  const std::string advice = fmt::format("--method {}", fmt::join(method_names(), ", "));
  if (name.empty()) {
    faults.push_back({"method", "not given", advice});
    return;
  }
  const std::string meant = nearest(name, method_names());
  faults.push_back({"method", "'" + name + "' is no known method",
                    meant.empty() ? advice : "did you mean '" + meant + "'?"});
}

Difference parse_difference(std::string_view text) {
  if (text == "euclidean") return Difference::euclidean;
  if (text == "mean-absolute") return Difference::mean_absolute;
  throw std::invalid_argument("'" + std::string(text) + "' is neither euclidean nor mean-absolute");
}

Decision parse_decision(std::string_view text) {
  if (text == "probability") return Decision::probability;
  if (text == "uniqueness") return Decision::uniqueness;
  throw std::invalid_argument("'" + std::string(text) + "' is neither probability nor uniqueness");
}

Arithmetic parse_arithmetic(std::string_view text) {
  if (text == "float") return Arithmetic::float32;
  if (text == "int8") return Arithmetic::int8;
  if (text == "sketch") return Arithmetic::sketch;
  throw std::invalid_argument("'" + std::string(text) + "' is none of int8, float, sketch");
}

FullMap parse_full_map(std::string_view text) {
  if (text == "refuse") return FullMap::refuse;
  if (text == "forget-oldest") return FullMap::forget_oldest;
  if (text == "thin") return FullMap::thin;
  throw std::invalid_argument("'" + std::string(text) + "' is none of refuse, forget-oldest, thin");
}

/// Whether the probability was measured for such differences: SeqSLAM's patches are others.
bool calibrated(const MatcherConfig& config) {
  return config.difference == Difference::euclidean && !config.enhance;
}

/// What accepts a match. A threshold of the other kind would do nothing, and is a fault: it does
/// not choose, as a default that is written out would choose otherwise than one that is not.
void resolve_decision(const MatcherSettings& settings, MatcherConfig& config, Faults& faults) {
  const bool probability = !settings.paper && calibrated(config);
  config.decision =
      settings.decision.value_or(probability ? Decision::probability : Decision::uniqueness);
  config.min_probability = settings.min_probability.value_or(config.min_probability);
  config.patience = settings.patience.value_or(config.patience);
  config.max_uniqueness = settings.max_uniqueness.value_or(config.max_uniqueness);
  constexpr std::size_t by_uniqueness = 100;
  const bool sure_of_near = config.decision == Decision::probability;
  config.exclude = settings.exclude.value_or(sure_of_near ? config.exclude : by_uniqueness);
  if (config.decision == Decision::probability) {
    if (settings.max_uniqueness) {
      faults.push_back({"max-uniqueness", "the probability decides",
                        "--min-probability, or --decide-by uniqueness"});
    }
    return;
  }
  const std::string remedy = settings.decision
                                 ? "--max-uniqueness, or leave --decide-by uniqueness out"
                                 : "--max-uniqueness, or --decide-by probability";
  std::string why = "the uniqueness decides";
  if (!settings.decision) {
    why += settings.paper ? " under --paper" : ": no probability was measured of such differences";
  }
  if (settings.min_probability) faults.push_back({"min-probability", why, remedy});
  if (settings.patience) faults.push_back({"patience", why + ", and no frame waits", remedy});
}

}  // namespace

void add_matcher_options(OptionTable& options, MatcherSettings& settings) {
  MatcherConfig& config = settings.config;
  options.section("Matching");
  options.text("method", settings.method,
               "seqslam, seqcnnslam, a-seqcnnslam, o-seqcnnslam, or single: no sequence "
               "[o-seqcnnslam]");
  options.flag("paper", settings.paper, "follow the paper to the letter");
  options.add(
      {"ds", ValueKind::count, "sequence length, frames [20]", [&settings](std::string_view value) {
         settings.config.sequence_length = parse_count(value);
         settings.ds_given = true;
       }});
  options.number("vmin", config.vmin, "slowest trajectory, rows a frame [0.8]");
  options.number("vmax", config.vmax, "fastest trajectory, rows a frame [1.2]");
  options.add({"exclude", ValueKind::count,
               "closing loops, a reference's too: newest frames that are no places [20; 100 by "
               "uniqueness]",
               [&settings](std::string_view value) { settings.exclude = parse_count(value); }});
  options.add({"full-map", ValueKind::text,
               "closing loops, what a full map does: refuse new places, forget-oldest, or thin out "
               "where they are densest [refuse]",
               [&config](std::string_view value) { config.full_map = parse_full_map(value); }});
  options.section("Matching", Shown::in_help_all);
  options.count("k", config.k, "a-seqcnnslam: candidate ranges [10]");
  options.count("num", config.num, "a range holds this many rows and one [16]");
  options.count("reinit", config.reinit,
                "without relocalising: matched frames from one full search to the next [450]");
  options.count("initial-k", config.initial_k, "o-seqcnnslam: ranges at first [30]");
  options.add(
      {"standardise", ValueKind::on_off,
       "weigh features by their running statistics [on; off under --paper and for seqslam]",
       [&settings](std::string_view value) { settings.standardise = parse_on_off(value); }});
  options.count(
      "standardise-prior", config.standardisation.prior_frames,
      "weight, in frames, of what a drive starts from; of a map that nothing is added to, "
      "a third [15]");
  options.count("standardise-horizon", config.standardisation.horizon,
                "frames after which statistics have mostly moved on [30]");
  options.add({"keyframes", ValueKind::on_off,
               "where frames follow each other closely, or the robot stands, match those that show "
               "something new [on; off under --paper]",
               [&config](std::string_view value) { config.keyframes = parse_on_off(value); }});
  options.add(
      {"difference", ValueKind::text,
       "euclidean or mean-absolute [euclidean; mean-absolute for seqslam]",
       [&settings](std::string_view value) { settings.difference = parse_difference(value); }});
  options.add({"enhance", ValueKind::on_off,
               "enhance differences by the contrast with the rows around [off; on for seqslam]",
               [&settings](std::string_view value) { settings.enhance = parse_on_off(value); }});
  options.add(
      {"arithmetic", ValueKind::text,
       "int8: a byte a value; float; sketch: 256 bytes a place [int8; float under --paper, for "
       "seqslam and mean-absolute]",
       [&settings](std::string_view value) { settings.arithmetic = parse_arithmetic(value); }});
  options.add({"relocalise", ValueKind::on_off,
               "a- and o-seqcnnslam: scan a part of the map at every frame, never search all of it "
               "[on; off under --paper]",
               [&settings](std::string_view value) { settings.relocalise = parse_on_off(value); }});
  options.add({"slice", ValueKind::count,
               "places of the map that a frame scans to relocalise [4096, or as many as "
               "--relocalise-s takes]",
               [&settings](std::string_view value) {
                 settings.config.relocalising.rows_scanned = parse_count(value);
                 settings.slice_given = true;
               }});
  options.number(
      "relocalise-s", settings.relocalise_s,
      "seconds of driving, at 25 frames a second, in which the whole map is scanned [0.2]");
  options.count("distances", config.relocalising.distances,
                "most descriptor distances of a frame while relocalising is on [0: chosen by ds]");
  options.section("Decision");
  options.add({"min-probability", ValueKind::number,
               "a match is accepted from this probability on, above 0 to 1 [0.99]",
               [&settings](std::string_view value) {
                 settings.min_probability = static_cast<float>(parse_number(value));
               }});
  options.add({"patience", ValueKind::count,
               "a frame is answered this many frames later at the latest, 0 to 1000 [120]",
               [&settings](std::string_view value) { settings.patience = parse_count(value); }});
  options.section("Decision", Shown::in_help_all);
  options.add({"decide-by", ValueKind::text,
               "what accepts a match: probability or uniqueness [probability; uniqueness under "
               "--paper, for seqslam, mean-absolute and --enhance on]",
               [&settings](std::string_view value) { settings.decision = parse_decision(value); }});
  options.add({"max-uniqueness", ValueKind::number,
               "by uniqueness: a match is accepted up to this, above 0 to 1 [0.94]",
               [&settings](std::string_view value) {
                 settings.max_uniqueness = static_cast<float>(parse_number(value));
               }});
  options.count("rwindow", config.rwindow,
                "rows around the best that cannot be the runner-up [10]");
}

void check_effects(const MatcherSettings& settings, const MatcherConfig& config, Faults& faults) {
  const MatcherConfig usual;
  const bool learns = config.standardisation.on;
  const bool slices = scans(config) && !settings.slice_given;
  const char* const nothing_scanned = "no part of the map is scanned";
  // A default that is written out is what happens anyway.
  const bool seconds_given = settings.relocalise_s != MatcherSettings{}.relocalise_s;
  struct Idle {
    const char* flag;
    bool is;
    const char* why;
    const char* remedy = "leave it out";
  };
  for (const Idle& idle :
       {Idle{"full-map", config.use == Use::localise && config.full_map != usual.full_map,
             "a map that is only localised in is never full",
             "close loops within the drive, or leave it out"},
        Idle{"standardise-prior",
             !learns && config.standardisation.prior_frames != usual.standardisation.prior_frames,
             "features are not weighed", "--standardise on, or leave it out"},
        Idle{"standardise-horizon",
             !learns && config.standardisation.horizon != usual.standardisation.horizon,
             "features are not weighed", "--standardise on, or leave it out"},
        Idle{"slice", settings.slice_given && !scans(config), nothing_scanned},
        Idle{"relocalise-s", seconds_given && !slices,
             settings.slice_given ? "--slice says how many places a frame scans" : nothing_scanned},
        Idle{"distances", config.relocalising.distances != 0 && !relocalises(config),
             "it goes with relocalising, which is off"}}) {
    if (idle.is) faults.push_back({idle.flag, idle.why, idle.remedy});
  }
}

void suit_slice(MatcherConfig& config, const MatcherSettings& settings,
                std::size_t places) noexcept {
  if (settings.slice_given) return;
  constexpr double frames_a_second = 25.0;
  // 12.8 MB: 4 ms where memory gives 3.2 GB a second.
  constexpr std::size_t most = 400'000;
  const auto frames =
      static_cast<std::size_t>(std::clamp(settings.relocalise_s * frames_a_second, 1.0, 1e6));
  config.relocalising.rows_scanned =
      std::clamp((places + frames - 1) / frames, config.relocalising.rows_scanned, most);
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.push_back(method.name);
  return names;
}

bool compares_patches(const MatcherSettings& settings) {
  const bool seqslam = settings.method == "seqslam";
  return settings.difference ? *settings.difference == Difference::mean_absolute : seqslam;
}

MatcherConfig resolve(const MatcherSettings& settings, Use use, Faults& faults) {
  MatcherConfig config = settings.config;
  config.use = use;
  const bool patches = compares_patches(settings);
  config.difference = patches ? Difference::mean_absolute : Difference::euclidean;
  config.enhance = settings.enhance.value_or(settings.method == "seqslam");
  config.standardisation.on = settings.standardise.value_or(!settings.paper && !patches);
  config.blank_is_unreadable = !settings.paper;
  resolve_method(settings.method, config, faults);
  config.arithmetic = settings.arithmetic.value_or(settings.paper || patches ? Arithmetic::float32
                                                                             : Arithmetic::int8);
  config.relocalising.on = settings.relocalise.value_or(!settings.paper);
  resolve_decision(settings, config, faults);
  if (!(settings.relocalise_s > 0.0)) faults.push_back({"relocalise-s", "it must be above 0"});
  if (settings.method == "single") {
    config.sequence_length = 0;
    if (settings.ds_given)
      faults.push_back({"ds", "single images are no sequence", "leave ds out"});
  } else if (config.sequence_length == 0) {
    faults.push_back({"ds", "0 frames are no sequence", "take --method single, or 1 or more"});
  }
  for (Fault& fault : validate(config)) faults.push_back(in_flags(std::move(fault)));
  return config;
}

}  // namespace seqloop::program
