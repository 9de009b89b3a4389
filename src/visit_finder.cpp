// SPDX-License-Identifier: MIT
#include "seqloop/visit_finder.hpp"

#include <algorithm>
#include <optional>

namespace seqloop {
namespace {

/// The usual settings, which take any drive at a cost that does not grow with the map. How
/// descriptors are compared is the map's.
MatcherConfig to_close_loops(const MatcherConfig& config, std::size_t places) {
  MatcherConfig closing;
  closing.use = Use::close_loops;
  closing.difference = config.difference;
  closing.arithmetic = config.arithmetic;
  closing.standardisation = config.standardisation;
  closing.keyframes = has_keyframes(config);
  closing.blank_is_unreadable = config.blank_is_unreadable;
  // Each step is a place here, so that none is further back, and what was asked for takes memory.
  closing.exclude = std::min(config.exclude, std::max<std::size_t>(places, 1));
  return closing;
}

/// A map that starts from what the other one knows of descriptors.
PlaceMap beside(const MatcherConfig& config, const PlaceMap& map, std::size_t places) {
  PlaceMap own(config, {places, map.descriptor_size()});
  const RunningStatistics& known = map.statistics();
  static_cast<void>(own.set_statistics(known.mean(), known.variance(), known.frames()));
  own.set_columns(map.columns());
  return own;
}

}  // namespace

VisitFinder::VisitFinder(const MatcherConfig& config, const PlaceMap& map, std::size_t places)
    : map_(beside(to_close_loops(config, places), map, places)),
      detector_(to_close_loops(config, places), map_) {}

void VisitFinder::take(std::span<const float> descriptor) noexcept {
  if (map_.size() < map_.capacity()) note(detector_.step(descriptor).answers);
}

void VisitFinder::note(std::span<const Answer> answers) noexcept {
  comes_back_ = comes_back_ || std::ranges::count(answers, Gate::match, &Answer::gate) > 0;
}

void VisitFinder::link(PlaceMap& map) noexcept {
  note(detector_.finish());
  if (!comes_back_) return;
  const PlaceOrder& own = map_.order();
  const PlaceOrder& order = map.order();
  // The same frames are places as in the map's newest session.
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
