// SPDX-License-Identifier: MIT
// The ground as strips between cross-sections of the road.
#include <cmath>

#include "scene.hpp"

namespace seqloop::street {
namespace {

constexpr double kWide = 60.0;  // metres of ground to each side of a straight road
constexpr double kLap = 0.05;   // metres by which strips overlap, so that no pixel falls between

}  // namespace

void add_ground(const World& world, const Layout& layout, Scene& scene) {
  const auto seed = static_cast<std::uint32_t>(hash_of(world.seed(), 0x67726f75));
  for (const Piece& piece : layout.pieces()) {
    // Strips begin at round street metres, so that they do not crawl along with the camera.
    const double from = std::floor((piece.begin + piece.offset) / 3.0) * 3.0;
    Cell cell;
    std::int64_t known = -1'000'000;
    for (double s = from; s < piece.end + piece.offset; s += 3.0) {
      const double p0 = std::max(s - piece.offset, std::max(piece.begin, layout.begin()));
      const double p1 = std::min(s + 3.0 - piece.offset, std::min(piece.end, layout.end()));
      if (p1 - p0 < 0.01) continue;
      const Vec3 a = layout.place(p0, 0.0);
      const Vec3 b = layout.place(p1, 0.0);
      const double size = length(b - a);
      const double half_turn = std::tan(0.5 * wrap_angle(layout.turn(p1) - layout.turn(p0)));
      // On the inside of a bend the strip ends before its two cross-sections meet.
      const double limit = 0.42 * size / std::max(1e-6, std::fabs(half_turn));
      const double left = half_turn > 0.0 ? std::min(kWide, limit) : kWide;
      const double right = half_turn < 0.0 ? std::min(kWide, limit) : kWide;
      const auto k = static_cast<std::int64_t>(std::floor((p0 + piece.offset + 0.01) / kCell));
      if (k != known) {
        cell = world.cell(k);
        known = k;
      }
      Strip strip;
      strip.street = static_cast<float>(p0 + piece.offset - static_cast<double>(k) * kCell);
      strip.length = static_cast<float>(p1 - p0);
      strip.bend = static_cast<float>(half_turn);
      strip.crossing = cell.crossing;
      strip.cell = static_cast<std::int32_t>(k);
      strip.seed = seed;
      strip.paving = cell.paving;
      strip.verge = cell.verge;
      scene.strips.push_back(strip);
      const Vec3 along = (b - a) * (1.0 / size);
      const Vec3 across{-along.y, along.x, 0.0};
      scene.add(Material::ground, scene.strips.size() - 1, a, along, across,
                {{-half_turn * right - kLap, -right},
                 {size + half_turn * right + kLap, -right},
                 {size - half_turn * left + kLap, left},
                 {half_turn * left - kLap, left}});
    }
  }
}

}  // namespace seqloop::street
