// SPDX-License-Identifier: MIT
#pragma once

#include "program/drives/stills_source.hpp"
#include "program/options/options.hpp"

namespace seqloop::program {

/// The flags that say which frames of a drive are taken, and what of them.
/// @param settings lives as long as the table
void add_stills_options(OptionTable& options, StillsSettings& settings);

/// @param text WxH or WxH+X+Y in pixels. Throws std::invalid_argument: why not.
[[nodiscard]] Crop parse_crop(std::string_view text);

/// @param text name of a CSV file `from_s,to_s`, or a list like `90-120,1:02:10-1:03:00`: seconds,
/// minutes:seconds or hours:minutes:seconds. Throws std::invalid_argument: why not.
[[nodiscard]] std::vector<Interval> parse_intervals(const std::string& text);

}  // namespace seqloop::program
