// SPDX-License-Identifier: MIT
#include "seqloop/matcher_config.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detail/scene.hpp"
#include "seqloop/detail/trajectories.hpp"

namespace seqloop {
namespace {

/// As few digits as tell it from all others: what is just beyond a limit is not that limit.
template <class Value>
std::string number(Value value) {
  std::array<char, 32> text;
  return {text.begin(), std::to_chars(text.begin(), text.end(), value).ptr};
}

void check_range(Faults& faults, const char* name, std::size_t value, std::size_t low,
                 std::size_t high) {
  if (value >= low && value <= high) return;
  faults.push_back({name, std::to_string(value) + " is not between " + std::to_string(low) +
                              " and " + std::to_string(high)});
}

/// @param last choice; the first is 0
template <class Choice>
void check_choice(Faults& faults, const char* name, Choice value, Choice last) {
  if (value <= last) return;
  faults.push_back({name,
                    std::to_string(static_cast<int>(value)) + " is none of its values, 0 to " +
                        std::to_string(static_cast<int>(last)),
                    "take one that has a name"});
}

// Rows a frame.
constexpr double fastest = 10.0;

/// @return whether lines can be counted with them
bool check_velocities(Faults& faults, const MatcherConfig& config) {
  const auto check = [&](const char* name, double velocity) {
    if (velocity >= 0.0 && velocity <= fastest) return true;
    faults.push_back({name, number(velocity) + " is not between 0 and 10 rows a frame"});
    return false;
  };
  const bool vmin_fits = check("vmin", config.vmin);
  const bool vmax_fits = check("vmax", config.vmax);
  if (!vmin_fits || !vmax_fits) return false;
  if (config.vmin > config.vmax) {
    faults.push_back({"vmin", number(config.vmin) + " is above vmax, " + number(config.vmax)});
  } else if (velocity_range(config.sequence_length, config.vmin, config.vmax).count() == 0) {
    faults.push_back({"vmin, vmax",
                      "no velocity m/" + std::to_string(config.sequence_length) + " lies between " +
                          number(config.vmin) + " and " + number(config.vmax),
                      "widen the range or raise sequence_length"});
  }
  return config.vmin <= config.vmax;
}

/// Distances that a range of num + 1 rows takes a frame while it moves along with the robot: the
/// newest column, what lines to the window's oldest column reach in addition, and what enhances
/// them.
std::size_t distances_of_one_range(const MatcherConfig& config) {
  const auto spread = static_cast<std::size_t>(
      std::ceil((config.vmax - config.vmin) * static_cast<double>(config.sequence_length)));
  const std::size_t around = config.enhance ? config.rwindow / 2 * 2 : 0;
  return config.num + 1 + spread + around;
}

}  // namespace

bool relocalises(const MatcherConfig& config) noexcept {
  return config.relocalising.on && config.candidates != Candidates::all;
}

bool has_keyframes(const MatcherConfig& config) noexcept {
  return config.keyframes && relocalises(config) && config.decision == Decision::probability &&
         config.standardisation.on;
}

bool moves_frames(const MatcherConfig& config) noexcept {
  return relocalises(config) && config.decision == Decision::probability &&
         config.standardisation.on && config.difference == Difference::euclidean;
}

bool scans(const MatcherConfig& config) noexcept {
  return relocalises(config) || config.decision == Decision::probability;
}

std::size_t distances_a_frame(const MatcherConfig& config) noexcept {
  constexpr std::size_t least = 256;
  if (config.relocalising.distances != 0) return config.relocalising.distances;
  constexpr std::size_t ranges = 7;
  return std::max(least, ranges * distances_of_one_range(config));
}

std::size_t least_places(const MatcherConfig& config) noexcept {
  const auto ds = static_cast<double>(config.sequence_length);
  return config.exclude + config.sequence_length + 2 +
         // Asked before the velocities are known to be any.
         static_cast<std::size_t>(std::ceil(std::min(std::max(0.0, config.vmin), fastest) * ds));
}

Faults validate(const MatcherConfig& config) {
  constexpr std::size_t many = 1'000'000'000;
  Faults faults;
  check_choice(faults, "candidates", config.candidates, Candidates::adaptive);
  check_choice(faults, "difference", config.difference, Difference::mean_absolute);
  check_choice(faults, "arithmetic", config.arithmetic, Arithmetic::sketch);
  check_choice(faults, "use", config.use, Use::close_loops);
  check_choice(faults, "full_map", config.full_map, FullMap::thin);
  check_choice(faults, "decision", config.decision, Decision::uniqueness);
  check_range(faults, "sequence_length", config.sequence_length, 0, 2'000);
  const bool velocities_fit = check_velocities(faults, config);
  check_range(faults, "rwindow", config.rwindow, 0, many);
  if (config.enhance && config.rwindow < 2) {
    faults.push_back({"rwindow", std::to_string(config.rwindow) + " leaves no rows to enhance by",
                      "take 2 or more, or switch enhance off"});
  }
  if (config.enhance && config.use == Use::close_loops && config.exclude <= config.rwindow / 2) {
    faults.push_back({"exclude",
                      std::to_string(config.exclude) + " is not above half of rwindow, " +
                          std::to_string(config.rwindow / 2) +
                          ": a difference would be enhanced by places that are still to come",
                      "raise exclude, or lower rwindow"});
  }
  check_range(faults, "k", config.k, 1, 1'000);
  check_range(faults, "initial_k", config.initial_k, 1, 1'000);
  check_range(faults, "num", config.num, 1, many);
  check_range(faults, "reinit", config.reinit, 1, many);
  if (scans(config)) {
    const bool believes = config.decision == Decision::probability;
    check_range(faults, "relocalising.rows_scanned", config.relocalising.rows_scanned,
                believes ? SceneGauge::least_rows : 2, many);
  }
  if (relocalises(config)) {
    check_range(faults, "relocalising.distances", config.relocalising.distances, 0, many);
    const std::size_t least = velocities_fit ? distances_of_one_range(config) : 0;
    if (config.relocalising.distances != 0 && config.relocalising.distances < least) {
      faults.push_back({"relocalising.distances",
                        std::to_string(config.relocalising.distances) +
                            " is less than one range takes, " + std::to_string(least),
                        "raise it, or lower num, sequence_length or vmax, or switch enhance off"});
    }
  }
  if (config.arithmetic != Arithmetic::float32 && config.difference == Difference::mean_absolute) {
    faults.push_back(
        {"arithmetic", "pictures are compared as float only", "set arithmetic to float32"});
  }
  if (config.full_map != FullMap::refuse && config.enhance) {
    faults.push_back({"full_map", "differences are enhanced by places that would go",
                      "set full_map to refuse, or switch enhance off"});
  }
  // Closing loops, the detector remembers that many steps: 8 MB at most, half a day of a camera.
  check_range(faults, "exclude", config.exclude, 1,
              config.use == Use::close_loops ? 1'000'000 : many);
  check_range(faults, "frames_at_once", config.frames_at_once, 1,
              MatcherConfig::most_frames_at_once);
  check_range(faults, "standardisation.prior_frames", config.standardisation.prior_frames, 1, many);
  check_range(faults, "standardisation.horizon", config.standardisation.horizon, 1, many);
  check_range(faults, "patience", config.patience, 0, 1'000);
  if (!(config.min_probability > 0.0F && config.min_probability <= 1.0F)) {
    faults.push_back(
        {"min_probability", number(config.min_probability) + " is not above 0 and at most 1"});
  }
  if (!(config.max_uniqueness > 0.0F && config.max_uniqueness <= 1.0F)) {
    faults.push_back(
        {"max_uniqueness", number(config.max_uniqueness) + " is not above 0 and at most 1"});
  }
  return faults;
}

Faults validate(const Capacity& capacity, const MatcherConfig& config) {
  constexpr std::size_t most_places = std::numeric_limits<std::uint32_t>::max();
  Faults faults;
  check_range(faults, "places", capacity.places, 1, most_places);
  check_range(faults, "descriptor_size", capacity.descriptor_size, 1, std::size_t{1} << 22U);
  check_range(faults, "sessions", capacity.sessions, 1, most_places);
  const bool small = config.arithmetic != Arithmetic::float32 || scans(config);
  if (small && capacity.descriptor_size > most_small_values) {
    faults.push_back({"descriptor_size",
                      std::to_string(capacity.descriptor_size) +
                          " values are too many for whole numbers and sketches, " +
                          std::to_string(most_small_values) + " at most",
                      "set arithmetic to float32, relocalising.on to false and decision to "
                      "uniqueness"});
  }
  return faults;
}

void check(const MatcherConfig& config, const Capacity& capacity) {
  Faults faults = validate(config);
  for (Fault& fault : validate(capacity, config)) faults.push_back(std::move(fault));
  if (!faults.empty()) throw SetupError(std::move(faults));
}

}  // namespace seqloop
