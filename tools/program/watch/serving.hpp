// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "program/map/lasting_map.hpp"
#include "program/map/place_pictures.hpp"
#include "program/options/options.hpp"
#include "program/watch/watch.hpp"

namespace seqloop::program {

/// Whether a run is shown in a browser, and to whom.
struct ServeSettings {
  std::optional<std::string> address;  ///< ADDR:PORT, empty: the default; none: it is not shown
  std::filesystem::path token;         ///< file that holds it; empty: a new one
};

/// Flags `--serve` and `--serve-token`. @param settings lives as long as the table
void add_serve_options(OptionTable& options, ServeSettings& settings);

/// Adds what is wrong with the address and the token, before anything is opened there.
/// @param settings with an address
void check(const ServeSettings& settings, Faults& faults);

/// A run that can be looked at in a browser, and read by a monitor, while it goes on: pages, JSON,
/// metrics, as the page of the room `platform/http` lists them. The loop hands snapshots to
/// `watch()`; everything else happens in threads of the lowest priority, which no frame waits for.
class Serving {
 public:
  /// Listens from here on, and says on stderr where, and by which token it may be controlled.
  /// @param run what the run was started with, as `RunView` takes it
  /// @param own_places whether places are frames of the drive itself
  /// @param pictures of a map's places; null: there are those that `add_place` brings
  /// Throws SetupError: no such address, taken, no token in the file; a program without a server.
  Serving(const ServeSettings& settings, nlohmann::ordered_json run, bool own_places,
          std::unique_ptr<PlacePictures> pictures);
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  Serving(Serving&&) = delete;
  Serving& operator=(Serving&&) = delete;
  ~Serving();  ///< tells those who look that the run has ended, and closes

  [[nodiscard]] Watch& watch() noexcept;

  /// A picture of a place, before the first frame. Allocates: yes.
  void add_place(const Image& image, std::uint64_t number);

  /// The map that the drive is added to, from when it has begun. @param map lives longer
  void keep_in(LastingMap& map);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::program
