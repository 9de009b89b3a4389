// SPDX-License-Identifier: MIT
#include "scene.hpp"

#include <cmath>

namespace seqloop::street {

Surface make_surface(const Camera& camera, Vec3 origin, Vec3 along_u, Vec3 along_v,
                     std::initializer_list<Corner> corners) {
  Surface s;
  const auto turned = [&](Vec3 d) { return camera.to_camera(camera.eye + d); };
  s.origin = camera.to_camera(origin);
  s.along_u = turned(along_u);
  s.along_v = turned(along_v);
  for (const Corner& c : corners) {
    s.corners[s.corner_count++] = s.origin + s.along_u * c.u + s.along_v * c.v;
  }
  return s;
}

void Scene::clear() {
  surfaces.clear();
  facades.clear();
  strips.clear();
  cars.clear();
  sprites.clear();
  shadows.clear();
}

Surface* Scene::add(Material material, std::size_t item, Vec3 origin, Vec3 along_u, Vec3 along_v,
                    std::initializer_list<Corner> corners) {
  Surface s = make_surface(camera, origin, along_u, along_v, corners);
  bool ahead = false;
  for (int i = 0; i < s.corner_count; ++i) ahead = ahead || s.corners[i].z > 0.2;
  if (!ahead) return nullptr;
  s.material = material;
  s.item = static_cast<std::uint32_t>(item);
  Vec3 normal = cross(along_u, along_v);
  if (dot(normal, camera.eye - origin) < 0.0) normal = normal * -1.0;
  s.sun = static_cast<float>(std::max(0.0, dot(normal, to_sun)));
  surfaces.push_back(s);
  return &surfaces.back();
}

void Scene::add_wall_shadow(Vec3 a, Vec3 b, double height) {
  const double along = to_sun.z > 0.05 ? height / to_sun.z : height * 20.0;
  const Vec3 cast{-to_sun.x * along, -to_sun.y * along, 0.0};
  const Vec3 x{1.0, 0.0, 0.0};
  const Vec3 y{0.0, 1.0, 0.0};
  const Vec3 c = b + cast;
  const Vec3 d = a + cast;
  shadows.push_back(
      {make_surface(camera, Vec3{}, x, y, {{a.x, a.y}, {b.x, b.y}, {c.x, c.y}, {d.x, d.y}}), false,
       false, 1.0F});
}

void Scene::add_round_shadow(Vec3 at, double width, double height) {
  const double stretch = to_sun.z > 0.1 ? 1.0 / to_sun.z : 10.0;
  const Vec3 centre{at.x - to_sun.x * stretch * height * 0.62,
                    at.y - to_sun.y * stretch * height * 0.62, 0.0};
  const double flat = std::hypot(to_sun.x, to_sun.y);
  if (flat < 1e-3) return;
  const Vec3 u{to_sun.x / flat, to_sun.y / flat, 0.0};
  const Vec3 v{-u.y, u.x, 0.0};
  const double a = 0.5 * width * std::hypot(1.0, 0.8 * flat * stretch);
  const double b = 0.5 * width;
  Shadow shadow{make_surface(camera, centre, u * a, v * b, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}),
                false, true, 0.85F};
  shadows.push_back(shadow);
}

void add_prop(const Prop& prop, const Piece& piece, const Layout& layout, Scene& scene) {
  const double p = prop.s - piece.offset;
  const Vec3 foot = layout.place(p, prop.d);
  Sprite s;
  s.foot = scene.camera.to_camera(foot);
  const bool crown = prop.thing == Thing::broadleaf || prop.thing == Thing::conifer;
  if (crown && scene.light->sun.r > 0.3F) {
    scene.add_round_shadow(foot, prop.width, prop.height);
  }
  if (s.foot.z < 0.8) return;
  s.thing = prop.thing;
  s.seed = prop.seed;
  s.width = static_cast<float>(prop.width);
  s.height = static_cast<float>(prop.height);
  s.sun = 0.55F;
  scene.sprites.push_back(s);
}

void add_fence(const Fence& fence, const Piece& piece, const Layout& layout, Scene& scene) {
  const double begin = std::max(fence.begin - piece.offset, layout.begin());
  const double end = std::min(fence.end - piece.offset, layout.end());
  for (double p = begin; p < end - 0.1; p += 8.0) {
    const double to = std::min(p + 8.0, end);
    const Vec3 a = layout.place(p, fence.d);
    const Vec3 b = layout.place(to, fence.d);
    const double size = length(b - a);
    if (size < 0.05) continue;
    const double u0 = p + piece.offset - fence.begin;
    const Vec3 along = (b - a) * (1.0 / size);
    Surface* s =
        scene.add(Material::fence, fence.hedge ? 1 : 0, a - along * u0, along, Vec3{0, 0, 1},
                  {{u0, 0}, {u0 + size, 0}, {u0 + size, fence.height}, {u0, fence.height}});
    if (s != nullptr) s->color = fence.color;
  }
}

void add_people(std::int64_t cell, const Piece& piece, const Layout& layout, Scene& scene) {
  Dice dice(hash_of(scene.traffic, 0x70656f70, cell, piece.leg));
  for (int count = dice.below(4); count > 0; --count) {
    const double side = dice.chance(0.5) ? 1.0 : -1.0;
    const double s = (static_cast<double>(cell) + dice.range(0.0, 1.0)) * kCell;
    const double d = side * dice.range(6.4, 8.2);
    const double height = dice.range(1.55, 1.9);
    const double p = s - piece.offset;
    const auto seed = static_cast<std::uint32_t>(dice.bits());
    if (p < piece.begin || p > piece.end) continue;
    add_prop({Thing::person, seed, s, d, 0.75, height}, piece, layout, scene);
  }
}

void build_scene(const World& world, const Path& path, const Shot& shot, int width, int height,
                 Scene& scene) {
  scene.clear();
  const Layout layout(path, shot.leg, shot.position);
  const Vec3 eye{0.0, shot.lateral, shot.height};
  // A driver looks a little into the curve.
  const double into_curve = 0.35 * layout.turn(shot.position + 14.0);
  scene.camera = make_camera(eye, shot.yaw + into_curve, shot.pitch, shot.roll, width, height);
  scene.light = &shot.light;
  scene.traffic = shot.traffic;
  const double azimuth = static_cast<double>(shot.light.sun_azimuth) - layout.heading();
  const double up = static_cast<double>(shot.light.sun_elevation);
  scene.to_sun = {std::cos(azimuth) * std::cos(up), std::sin(azimuth) * std::cos(up), std::sin(up)};
  for (const Piece& piece : layout.pieces()) {
    const double from = piece.begin + piece.offset;
    const double to = piece.end + piece.offset;
    const auto first = static_cast<std::int64_t>(std::floor(from / kCell));
    const auto last = static_cast<std::int64_t>(std::floor(to / kCell));
    // A thing counts when it stands wholly on the piece, or runs out of view at either end.
    const auto shown = [&](double begin, double end) {
      const bool cut_front = begin < from && piece.begin > layout.begin() + 0.01;
      const bool cut_back = end > to && piece.end < layout.end() - 0.01;
      if (end < from || begin > to || cut_front || cut_back) return false;
      return !path.in_bend(piece.leg, begin - piece.offset) &&
             !path.in_bend(piece.leg, end - piece.offset);
    };
    for (std::int64_t k = first; k <= last; ++k) {
      const Cell cell = world.cell(k);
      for (const Building& b : cell.buildings) {
        if (shown(b.begin, b.end)) add_building(b, piece, layout, scene);
      }
      for (const Fence& f : cell.fences) {
        if (shown(f.begin, f.end)) add_fence(f, piece, layout, scene);
      }
      for (const Prop& p : cell.props) {
        if (shown(p.s, p.s)) add_prop(p, piece, layout, scene);
      }
      add_parked_cars(k, world, piece, layout, scene);
      add_people(k, piece, layout, scene);
    }
  }
  add_oncoming_cars(shot, layout, scene);
  add_ground(world, layout, scene);
}

}  // namespace seqloop::street
