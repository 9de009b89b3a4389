// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// The matcher as the command line puts it.
struct MatcherSettings {
  MatcherConfig config;
  std::string method = "o-seqcnnslam";
  bool paper = false;
  bool ds_given = false;
  std::optional<Difference> difference;  ///< mean absolute for SeqSLAM alone, when nobody says
  std::optional<bool> standardise;       ///< on unless --paper or SeqSLAM, when nobody says
  std::optional<bool> enhance;           ///< on for SeqSLAM alone, when nobody says
  std::optional<Arithmetic> arithmetic;  ///< float under --paper and for SeqSLAM, otherwise int8
  std::optional<Decision> decision;      ///< by probability unless --paper, when nobody says
  std::optional<float> min_probability;
  std::optional<std::size_t> patience;  ///< frames
  std::optional<float> max_uniqueness;
  std::optional<std::size_t> exclude;  ///< frames; 20 by probability, otherwise 100
  std::optional<bool> relocalise;      ///< on unless --paper, when nobody says
  bool slice_given = false;
  double relocalise_s = 0.2;  ///< seconds of driving until the whole map was looked at
};

/// @param settings lives as long as the table
void add_matcher_options(OptionTable& options, MatcherSettings& settings);

/// What `--method` can be.
[[nodiscard]] std::vector<std::string> method_names();

/// Whether patch-normalised pictures are compared, as SeqSLAM does, not unit vectors.
[[nodiscard]] bool compares_patches(const MatcherSettings& settings);

/// @param faults everything that is wrong is added
/// @return the configuration to build a detector with, if there were none
[[nodiscard]] MatcherConfig resolve(const MatcherSettings& settings, Use use, Faults& faults);

/// Adds a fault for what does nothing in such a configuration. Experiments do not ask: their lists
/// may hold other ones, too.
void check_effects(const MatcherSettings& settings, const MatcherConfig& config, Faults& faults);

/// Chooses how many places a frame looks at, unless somebody said: as many as it takes to go round
/// the map in `relocalise_s` at 25 frames a second, from 4,096 up to what costs a tenth of a
/// frame's 40 ms. It follows from counts alone, so that answers are the same on every machine.
/// @param places that there is room for
void suit_slice(MatcherConfig& config, const MatcherSettings& settings,
                std::size_t places) noexcept;

}  // namespace seqloop::program
