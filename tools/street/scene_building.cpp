// SPDX-License-Identifier: MIT
// Houses as surfaces: front, flanks, roof, and what sticks out of the front.
#include <cmath>

#include "scene.hpp"

namespace seqloop::street {
namespace {

constexpr Vec3 kUp{0.0, 0.0, 1.0};

/// Height below which a front lies in the shade of the houses across the street.
float shade_line(const Scene& scene, Vec3 outward, std::uint32_t seed) {
  const double facing = dot(scene.to_sun, outward);
  if (facing < 0.02) return 1000.0F;
  const double across = 7.0 + 6.0 * unit(mix64(seed));
  return static_cast<float>(across - 17.0 * scene.to_sun.z / facing);
}

void add_box(Scene& scene, Vec3 at, Vec3 along, Vec3 out, double w, double d, double h, Color c) {
  const auto side = [&](Vec3 origin, Vec3 u, double size) {
    Surface* s =
        scene.add(Material::plain, 0, origin, u, kUp, {{0, 0}, {size, 0}, {size, h}, {0, h}});
    if (s != nullptr) s->color = c;
  };
  side(at + out * d, along, w);
  side(at, out, d);
  side(at + along * w, out, d);
  Surface* top =
      scene.add(Material::roof, 1, at + kUp * h, along, out, {{0, 0}, {w, 0}, {w, d}, {0, d}});
  if (top != nullptr) top->color = c;
}

void add_sign_and_awning(const Building& b, Vec3 a, Vec3 along, Vec3 out, double w, Scene& scene) {
  const auto ground = static_cast<double>(b.front.ground_height);
  if (b.awning) {
    const Vec3 slope = (out * 0.85 + kUp * -0.53);
    Surface* s = scene.add(Material::plain, 1, a + kUp * (ground - 0.45), along, slope,
                           {{0.4, 0}, {w - 0.4, 0}, {w - 0.4, 1.3}, {0.4, 1.3}});
    if (s != nullptr) s->color = b.front.accent;
  }
  if (b.hanging_sign) {
    const double at = w * (0.2 + 0.6 * unit(mix64(b.front.seed + 7U)));
    const double up = ground + 0.3;
    Surface* s = scene.add(Material::glow, 0, a + along * at, out, kUp,
                           {{0.15, up}, {1.15, up}, {1.15, up + 1.2}, {0.15, up + 1.2}});
    if (s != nullptr) {
      s->color = b.front.accent;
      s->item = b.front.seed;
    }
  }
}

void add_roof(const Building& b, Vec3 a, Vec3 along, Vec3 out, double w, Scene& scene) {
  const double half = 0.5 * b.depth;
  const double eaves = 0.5;
  if (b.ridge > 0.0) {
    const double slope = std::hypot(half, b.ridge);
    const Vec3 up = (out * -half + kUp * b.ridge) * (1.0 / slope);
    Surface* s = scene.add(Material::roof, 0, a + kUp * b.height, along, up,
                           {{-0.2, -eaves}, {w + 0.2, -eaves}, {w + 0.2, slope}, {-0.2, slope}});
    if (s != nullptr) s->color = b.roof;
    if (b.chimney) {
      const double at = w * (0.15 + 0.6 * unit(mix64(b.front.seed)));
      add_box(scene, a + along * at - out * half + kUp * (b.height + b.ridge - 0.8), along, out,
              0.9, 0.7, 1.9, b.front.wall * 0.7F);
    }
    return;
  }
  // A flat roof: its cornice is all that can be seen from the street.
  const Vec3 rim = kUp * (b.height - 0.1);
  add_box(scene, a + rim + out * -0.2 - along * 0.15, along, out, w + 0.3, 0.5, 0.45,
          b.front.trim * 0.8F);
  if (b.chimney) {
    add_box(scene, a + along * (w * 0.3) - out * half + kUp * b.height, along, out, w * 0.3, 2.0,
            2.4, b.front.wall * 0.6F);
  }
}

}  // namespace

void add_building(const Building& b, const Piece& piece, const Layout& layout, Scene& scene) {
  const double d = b.side * (kFacadeLine + b.setback);
  const double p0 = b.begin - piece.offset;
  const double p1 = b.end - piece.offset;
  if (p1 < layout.begin() || p0 > layout.end()) return;
  const Vec3 near = layout.place(p0, d);
  const Vec3 far = layout.place(p1, d);
  const double w = length(far - near);
  if (w < 0.5) return;
  // Whoever stands before the front has `a` on the left.
  const Vec3 a = b.side > 0 ? near : far;
  const Vec3 c = b.side > 0 ? far : near;
  const Vec3 along = (c - a) * (1.0 / w);
  const Vec3 out{along.y, -along.x, 0.0};
  const double h = b.height;

  Facade front = b.front;
  front.width = static_cast<float>(w);
  scene.facades.push_back(front);
  Surface* s = scene.add(Material::facade, scene.facades.size() - 1, a, along, kUp,
                         {{0, 0}, {w, 0}, {w, h}, {0, h}});
  if (s != nullptr) s->shade_below = shade_line(scene, out, front.seed);

  scene.facades.push_back(b.flank);
  const std::size_t flank = scene.facades.size() - 1;
  const double ridge = h + b.ridge;
  const auto add_flank = [&](Vec3 foot, Vec3 from_back) {
    Surface* f = scene.add(Material::facade, flank, foot, from_back, kUp,
                           {{0, 0}, {b.depth, 0}, {b.depth, h}, {0.5 * b.depth, ridge}, {0, h}});
    if (f != nullptr) f->shade_below = 2.0F;
  };
  add_flank(a - out * b.depth, out);
  add_flank(c, out * -1.0);
  add_roof(b, a, along, out, w, scene);
  add_sign_and_awning(b, a, along, out, w, scene);
  if (scene.light->sun.r > 0.3F) {
    scene.add_wall_shadow(a, c, h);
    scene.add_wall_shadow(a - out * (0.5 * b.depth), c - out * (0.5 * b.depth), ridge);
    scene.add_wall_shadow(near - out * b.depth, near, h);
    scene.add_wall_shadow(far - out * b.depth, far, h);
  }
}

}  // namespace seqloop::street
