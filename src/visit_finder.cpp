// SPDX-License-Identifier: MIT
#include "seqloop/visit_finder.hpp"

#include <optional>

namespace seqloop {
namespace {

/// The same settings, to close loops at a cost that does not grow with the map.
MatcherConfig to_close_loops(MatcherConfig config) {
  config.use = Use::close_loops;
  config.candidates = Candidates::adaptive;
  config.relocalising = {};
  config.full_map = FullMap::refuse;
  config.frames_at_once = 1;
  return config;
}

/// A map that starts from what the other one knows of descriptors.
PlaceMap beside(const MatcherConfig& config, const PlaceMap& map, std::size_t places) {
  PlaceMap own(config, {places, map.descriptor_size()});
  const RunningStatistics& known = map.statistics();
  static_cast<void>(own.set_statistics(known.mean(), known.variance(), known.frames()));
  return own;
}

}  // namespace

VisitFinder::VisitFinder(const MatcherConfig& config, const PlaceMap& map, std::size_t places)
    : map_(beside(to_close_loops(config), map, places)), detector_(to_close_loops(config), map_) {}

void VisitFinder::take(std::span<const float> descriptor) noexcept {
  static_cast<void>(detector_.step(descriptor));
}

void VisitFinder::link(PlaceMap& map) noexcept {
  static_cast<void>(detector_.finish());
  const PlaceOrder& own = map_.order();
  const PlaceOrder& order = map.order();
  // What could not be read is no place here: frames say which is which.
  const auto row_of = [&](std::size_t row) { return order.row_of_frame(own.frame(row)); };
  for (std::size_t row = 0; row < map_.size(); ++row) {
    const std::optional<std::size_t> first = own.row_of_number(map_.first_visit(row));
    if (!first || *first == row) continue;
    const std::size_t visit = row_of(row);
    const std::size_t visited = row_of(*first);
    if (visit < map.size() && visited < map.size()) {
      map.set_first_visit(visit, order.number(visited));
    }
  }
}

}  // namespace seqloop
