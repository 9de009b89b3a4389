#pragma once

#include <optional>
#include <string>

#include "seqloop/matcher_config.hpp"
#include "seqloop/options.hpp"

namespace seqloop::program {

/// The matcher as the command line puts it.
struct MatcherSettings {
  MatcherConfig config;
  std::string method;
  bool paper = false;
  std::optional<bool> standardise;  ///< on unless --paper, when nobody says
  bool enhance = false;
  std::string arithmetic = "float";
};

/// @param settings lives as long as the table
void add_matcher_options(OptionTable& options, MatcherSettings& settings);

/// @param faults everything that is wrong is added
/// @return the configuration to build a detector with, if there were none
[[nodiscard]] MatcherConfig resolve(const MatcherSettings& settings, Use use, Faults& faults);

}  // namespace seqloop::program
