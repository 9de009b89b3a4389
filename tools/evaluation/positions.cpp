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
  table.for_each_row([&](std::size_t row) {
    const std::uint64_t number = table.whole(row, frame);
    if (!seen.insert(number).second) {
      throw SetupError({table.where(row), "frame " + std::to_string(number) + " is given twice"});
    }
    positions.places.push_back(
        {number, on_plan ? std::array{0.0, table.number_within(row, first, -farthest_m, farthest_m),
                                      table.number_within(row, second, -farthest_m, farthest_m)}
                         : on_ball(table.number_within(row, first, -90.0, 90.0),
                                   table.number_within(row, second, -180.0, 360.0))});
  });
  if (positions.places.empty()) throw SetupError({table.name(), "it has no rows"});
  return positions;
}

}  // namespace seqloop::evaluation
