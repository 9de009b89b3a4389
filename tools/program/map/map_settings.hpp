// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "program/options/options.hpp"

namespace seqloop::program {

/// A map that lasts, as the command line puts it.
struct MapSettings {
  std::filesystem::path file;  ///< empty: none
  bool read_only = false;
  std::string session;        ///< name of the drive that is added; empty: when it began
  double save_every_s = 1.0;  ///< of driving, at most, are not saved yet
  bool thumbnails = true;     ///< of places that have pictures
  bool waits = false;         ///< frames wait for the disk where it is far behind: no camera does
  bool novel = true;          ///< whole sessions go that were superseded; otherwise all stay
};

/// @param settings lives as long as the table
void add_map_options(OptionTable& options, MapSettings& settings);

/// For a verb that has pictures.
void add_thumbnail_option(OptionTable& options, MapSettings& settings);

/// Adds a fault for what does not go together. @param reference whether there is one, too
void check(const MapSettings& settings, bool reference, Faults& faults);

}  // namespace seqloop::program
