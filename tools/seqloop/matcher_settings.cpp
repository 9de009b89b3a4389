#include "seqloop/matcher_settings.hpp"

#include <utility>

namespace seqloop::program {
namespace {

void resolve_method(const std::string& method, MatcherConfig& config, Faults& faults) {
  static const std::vector<std::string> methods{"seqcnnslam", "a-seqcnnslam", "o-seqcnnslam"};
  if (method == "seqcnnslam") {
    config.candidates = Candidates::all;
  } else if (method == "a-seqcnnslam") {
    config.candidates = Candidates::ranges;
  } else if (method == "o-seqcnnslam") {
    config.candidates = Candidates::adaptive;
  } else if (method == "seqslam") {
    faults.push_back({"method", "seqslam is not in this version",
                      "take seqcnnslam, a-seqcnnslam or o-seqcnnslam"});
  } else if (method.empty()) {
    faults.push_back({"method", "not given", "--method seqcnnslam, a-seqcnnslam or o-seqcnnslam"});
  } else {
    const std::string meant = nearest(method, methods);
    faults.push_back({"method", "'" + method + "' is no known method",
                      meant.empty() ? "take seqcnnslam, a-seqcnnslam or o-seqcnnslam"
                                    : "did you mean '" + meant + "'?"});
  }
}

}  // namespace

void add_matcher_options(OptionTable& options, MatcherSettings& settings) {
  MatcherConfig& config = settings.config;
  options.text("method", settings.method, "seqcnnslam, a-seqcnnslam or o-seqcnnslam");
  options.flag("paper", settings.paper, "follow the paper to the letter");
  options.count("ds", config.sequence_length, "sequence length, frames [20]");
  options.number("vmin", config.vmin, "slowest trajectory, rows a frame [0.8]");
  options.number("vmax", config.vmax, "fastest trajectory, rows a frame [1.2]");
  options.count("rwindow", config.rwindow, "rows around the best that are no rivals [10]");
  options.count("k", config.k, "a-seqcnnslam: candidate ranges [10]");
  options.count("num", config.num, "a range holds this many rows and one [16]");
  options.count("reinit", config.reinit, "matched frames from one full search to the next [450]");
  options.count("initial-k", config.initial_k, "o-seqcnnslam: ranges at first [30]");
  options.count("exclude", config.exclude, "closing loops: newest frames that are no places [100]");
  options.add(
      {"standardise", ValueKind::on_off,
       "weigh features by their running statistics [on, off under --paper]",
       [&settings](std::string_view value) { settings.standardise = parse_on_off(value); }});
  options.count("standardise-prior", config.standardisation.prior_frames,
                "frames that the map's statistics count for in a new drive [20]");
  options.count("standardise-horizon", config.standardisation.horizon,
                "frames after which statistics have mostly moved on [100]");
  options.number("max-uniqueness", config.max_uniqueness,
                 "run: a match is reported up to this uniqueness, 0 to 1 [0.94]");
  options.on_off("enhance", settings.enhance, "local contrast enhancement [off]");
  options.text("arithmetic", settings.arithmetic, "float [float]");
}

MatcherConfig resolve(const MatcherSettings& settings, Use use, Faults& faults) {
  MatcherConfig config = settings.config;
  config.use = use;
  config.standardisation.on = settings.standardise.value_or(!settings.paper);
  config.blank_is_unreadable = !settings.paper;
  resolve_method(settings.method, config, faults);
  if (settings.enhance) {
    faults.push_back({"enhance", "contrast enhancement is not in this version", "--enhance off"});
  }
  if (settings.arithmetic != "float") {
    faults.push_back({"arithmetic", "'" + settings.arithmetic + "' is not in this version",
                      "--arithmetic float"});
  }
  for (Fault& fault : validate(config)) faults.push_back(std::move(fault));
  return config;
}

}  // namespace seqloop::program
