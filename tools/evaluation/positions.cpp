// SPDX-License-Identifier: MIT
#include "evaluation/positions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

constexpr double earth_radius_m = 6'371'008.8;  // the mean of the ellipsoid's three half axes
constexpr double farthest_m = 1e9;

std::array<double, 3> on_ball(double latitude, double longitude) {
  constexpr double degree = std::numbers::pi / 180.0;
  const double around = earth_radius_m * std::cos(latitude * degree);
  return {around * std::cos(longitude * degree), around * std::sin(longitude * degree),
          earth_radius_m * std::sin(latitude * degree)};
}

}  // namespace

double chord(double way_m) noexcept {
  const double angle = std::min(way_m / earth_radius_m, std::numbers::pi);
  return 2.0 * earth_radius_m * std::sin(angle / 2.0);
}

Positions Positions::from_csv(const CsvTable& table) {
  const bool on_plan = table.has("x") && table.has("y");
  Positions positions;
  positions.on_earth = table.has("latitude") && table.has("longitude");
  if (on_plan == positions.on_earth || !table.has("frame")) {
    throw SetupError({table.name(),
                      "it must have the columns frame,x,y (metres) or "
                      "frame,latitude,longitude (degrees)"});
  }
  const std::size_t frame = table.column("frame");
  const std::size_t first = table.column(on_plan ? "x" : "latitude");
  const std::size_t second = table.column(on_plan ? "y" : "longitude");
  std::set<std::uint64_t> seen;
  const double most_first = on_plan ? farthest_m : 90.0;
  const double least_second = on_plan ? -farthest_m : -180.0;
  const double most_second = on_plan ? farthest_m : 360.0;
  table.for_each_row([&](CsvRow& row) {
    const std::uint64_t number = row.whole(frame);
    const double x = row.number_within(first, -most_first, most_first);
    const double y = row.number_within(second, least_second, most_second);
    if (!row.faults().empty()) return;
    if (!seen.insert(number).second) {
      throw SetupError({row.where(), "frame " + std::to_string(number) + " is given twice"});
    }
    positions.places.push_back({number, on_plan ? std::array{0.0, x, y} : on_ball(x, y)});
  });
  if (positions.places.empty()) throw SetupError({table.name(), "it has no rows"});
  return positions;
}

}  // namespace seqloop::evaluation
