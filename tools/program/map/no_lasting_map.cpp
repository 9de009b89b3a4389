// SPDX-License-Identifier: MIT
// Where there is no SQLite.
#include "program/map/lasting_map.hpp"

namespace seqloop::program {

std::unique_ptr<LastingMap> open_map(const MapSettings& /*settings*/,
                                     const MatcherConfig& /*config*/,
                                     std::size_t /*descriptor_size*/, std::string /*describer*/,
                                     JpegEncoder /*encode*/) {
  throw SetupError({"map", "this build keeps none: it was made without SQLite",
                    "install libsqlite3-dev and build again"});
}

}  // namespace seqloop::program
