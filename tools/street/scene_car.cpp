// SPDX-License-Identifier: MIT
// Cars as surfaces: parked ones, and those that come the other way.
#include <cmath>

#include "scene.hpp"

namespace seqloop::street {
namespace {

CarPaint make_paint(Dice& dice) {
  CarPaint p;
  p.seed = static_cast<std::uint32_t>(dice.bits());
  p.van = dice.chance(0.2);
  p.length = p.van ? dice.rangef(4.8F, 5.6F) : dice.rangef(3.7F, 4.7F);
  p.height = p.van ? dice.rangef(1.9F, 2.4F) : dice.rangef(1.4F, 1.65F);
  const float grey = dice.rangef(0.02F, 0.8F);
  p.body = dice.chance(0.65) ? Color{grey, grey, grey * 1.04F}
                             : Color{dice.rangef(0.02F, 0.5F), dice.rangef(0.02F, 0.3F),
                                     dice.rangef(0.02F, 0.4F)};
  return p;
}

/// @param ahead +1 drives with the camera, -1 comes towards it.
void add_car(double p, double d, int ahead, const CarPaint& paint, const Layout& layout,
             Scene& scene) {
  const double turn = layout.turn(p) + (ahead > 0 ? 0.0 : kPi);
  const Vec3 along{std::cos(turn), std::sin(turn), 0.0};
  const Vec3 left{-along.y, along.x, 0.0};
  const Vec3 up{0.0, 0.0, 1.0};
  const auto len = static_cast<double>(paint.length);
  const auto top = static_cast<double>(paint.height);
  const double half = paint.van ? 0.95 : 0.86;
  const Vec3 back = layout.place(p, d) - along * (0.5 * len);
  scene.cars.push_back(paint);
  const std::size_t item = scene.cars.size() - 1;
  const double belt = paint.van ? 1.15 : 0.88;
  const double rear = paint.van ? 0.05 : 0.35;  // where the roof begins
  const double roof_end = paint.van ? len * 0.72 : len * 0.56;
  const double hood = paint.van ? len * 0.88 : len * 0.76;
  for (const double y : {half, -half}) {
    scene.add(Material::car, item, back + left * y, along, up,
              {{0.0, 0.18},
               {len, 0.18},
               {len, 0.62},
               {hood, belt},
               {roof_end, top},
               {rear + 0.4, top},
               {0.04, belt}});
  }
  const auto panel = [&](double x0, double z0, double x1, double z1, int kind) {
    const double size = std::hypot(x1 - x0, z1 - z0);
    const Vec3 v = along * ((x1 - x0) / size) + up * ((z1 - z0) / size);
    Surface* s = scene.add(Material::car, item, back + along * x0 + up * z0 + left * half,
                           left * -1.0, v, {{0, 0}, {2 * half, 0}, {2 * half, size}, {0, size}});
    if (s != nullptr) s->color.r = static_cast<float>(kind);
  };
  panel(0.0, 0.18, 0.04, belt, 1);           // back
  panel(0.04, belt, rear + 0.4, top, 3);     // rear window
  panel(rear + 0.4, top, roof_end, top, 4);  // roof
  panel(hood, belt, roof_end, top, 3);       // windscreen
  panel(len, 0.62, hood, belt, 4);           // bonnet
  panel(len, 0.18, len, 0.62, 2);            // front
  Shadow contact{make_surface(scene.camera, back, along, left,
                              {{-0.2, -half - 0.25},
                               {len + 0.2, -half - 0.25},
                               {len + 0.2, half + 0.25},
                               {-0.2, half + 0.25}}),
                 true, false, 0.75F};
  scene.shadows.push_back(contact);
  if (scene.light->sun.r > 0.3F) {
    const Vec3 a = back + left * half;
    const Vec3 b = back - left * half;
    scene.add_wall_shadow(a, b, belt);
    scene.add_wall_shadow(a + along * (len * 0.5), a, top * 0.9);
    scene.add_wall_shadow(b + along * (len * 0.5), b, top * 0.9);
  }
}

}  // namespace

void add_parked_cars(std::int64_t cell, const World& world, const Piece& piece,
                     const Layout& layout, Scene& scene) {
  for (const int side : {1, -1}) {
    Dice place(hash_of(world.seed(), 0x7061726b, cell, side));
    const double crowd = place.chance(0.3) ? 0.05 : place.range(0.25, 0.8);
    Dice dice(hash_of(world.seed(), 0x63617273, cell, side, scene.traffic, piece.leg));
    const double start = static_cast<double>(cell) * kCell + (world.crossing(cell) ? 19.0 : 3.5);
    const double end = static_cast<double>(cell + 1) * kCell - 7.0;
    for (double s = start + dice.range(0.0, 3.0); s < end; s += dice.range(5.6, 7.5)) {
      const bool here = dice.chance(crowd);
      const double d = side * dice.range(4.05, 4.35);
      const CarPaint paint = make_paint(dice);
      const double p = s - piece.offset;
      if (!here || p < layout.begin() || p > layout.end() || p < piece.begin || p > piece.end) {
        continue;
      }
      add_car(p, d, -side, paint, layout, scene);
    }
  }
}

void add_oncoming_cars(const Shot& shot, const Layout& layout, Scene& scene) {
  constexpr double kSlot = 110.0;  // metres from one chance of a car to the next
  constexpr double kSpeed = 1.1;   // metres a frame
  const double moved = kSpeed * shot.time;
  const auto first = static_cast<std::int64_t>(std::floor((layout.begin() + moved) / kSlot));
  const auto last = static_cast<std::int64_t>(std::floor((layout.end() + moved) / kSlot));
  for (std::int64_t k = first; k <= last; ++k) {
    Dice dice(hash_of(shot.traffic, 0x6f6e636f, k));
    if (!dice.chance(0.45)) continue;
    const double p = (static_cast<double>(k) + dice.range(0.1, 0.9)) * kSlot - moved;
    if (p > layout.begin() && p < layout.end()) {
      const double d = dice.range(1.5, 1.9);
      add_car(p, d, -1, make_paint(dice), layout, scene);
    }
  }
}

}  // namespace seqloop::street
