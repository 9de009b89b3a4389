// SPDX-License-Identifier: MIT
#include "renderer.hpp"

#include <cmath>

#include "shade.hpp"

namespace seqloop::street {

Renderer::Renderer(const Path& path, int width, int height)
    : path_(path),
      world_(path.street().seed()),
      g_(width, height),
      picture_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Renderer::render(const Shot& shot, cv::Mat& image) {
  build_scene(world_, path_, shot, g_.width, g_.height, scene_);
  g_.clear();
  const std::size_t count = std::min<std::size_t>(scene_.surfaces.size(), GBuffer::kNothing);
  for (std::size_t i = 0; i < count; ++i) {
    draw(scene_.surfaces[i], static_cast<std::uint16_t>(i), scene_.camera, g_);
  }
  draw_shadows();
  shade();
  shade_sky(scene_.camera, shot, path_.heading(shot.leg, shot.position), world_.seed(), g_,
            picture_);
  std::sort(scene_.sprites.begin(), scene_.sprites.end(),
            [](const Sprite& a, const Sprite& b) { return a.foot.z > b.foot.z; });
  for (const Sprite& sprite : scene_.sprites) draw_sprite(sprite);
  image.create(g_.height, g_.width, CV_8UC3);
  develop(picture_, shot.light, shot.noise, image);
}

void Renderer::draw_shadows() {
  for (const Shadow& shadow : scene_.shadows) {
    const Polygon polygon(shadow.area, scene_.camera);
    if (!polygon.visible()) continue;
    polygon.for_each_span([&](const Span& s) {
      const std::size_t row = static_cast<std::size_t>(s.y) * static_cast<std::size_t>(g_.width);
      for (int x = s.x0; x < s.x1; ++x) {
        const std::size_t i = row + static_cast<std::size_t>(x);
        if (g_.surface[i] == GBuffer::kNothing) continue;
        if (scene_.surfaces[g_.surface[i]].material != Material::ground) continue;
        float dark = shadow.strength;
        if (shadow.round) {
          const double k = x - s.x0;
          const double depth = 1.0 / (s.near + s.near_step * k);
          const auto u = static_cast<float>((s.u + s.u_step * k) * depth);
          const auto v = static_cast<float>((s.v + s.v_step * k) * depth);
          const float rim = noise(u * 5.0F + 9.0F, v * 5.0F, 81U);
          dark *= smooth(1.0F, 0.75F, u * u + v * v + 0.6F * rim);
        }
        if (shadow.contact) {
          g_.open[i] = std::min(g_.open[i], 1.0F - dark);
        }
        g_.sun[i] = std::min(g_.sun[i], 1.0F - dark);
      }
    });
  }
}

void Renderer::shade() {
  std::size_t i = 0;
  for (int y = 0; y < g_.height; ++y) {
    for (int x = 0; x < g_.width; ++x, ++i) {
      if (g_.surface[i] != GBuffer::kNothing) picture_[i] = shade_pixel(i, x, y);
    }
  }
}

Color Renderer::shade_pixel(std::size_t i, int x, int y) const {
  const Surface& s = scene_.surfaces[g_.surface[i]];
  const Light& light = *scene_.light;
  const float depth = 1.0F / g_.near[i];
  Spot spot{g_.u[i], g_.v[i], 0.0F, 0.0F};
  // A pixel's width on the surface: from the neighbours that show the same surface.
  const float least = depth / static_cast<float>(scene_.camera.focal);
  const auto width = static_cast<std::size_t>(g_.width);
  const std::size_t right = x + 1 < g_.width ? i + 1 : i - 1;
  const std::size_t below = y + 1 < g_.height ? i + width : i - width;
  spot.du = spot.dv = least;
  if (g_.surface[right] == g_.surface[i]) {
    spot.du = std::max(spot.du, std::fabs(g_.u[right] - spot.u));
    spot.dv = std::max(spot.dv, std::fabs(g_.v[right] - spot.v));
  }
  if (g_.surface[below] == g_.surface[i]) {
    spot.du = std::max(spot.du, std::fabs(g_.u[below] - spot.u));
    spot.dv = std::max(spot.dv, std::fabs(g_.v[below] - spot.v));
  }
  Paint paint;
  float sun = s.sun;
  switch (s.material) {
    case Material::facade:
      paint = paint_facade(scene_.facades[s.item], spot, light, scene_.traffic);
      sun *= smooth(s.shade_below - 0.3F, s.shade_below + 0.3F, spot.v);
      break;
    case Material::ground:
      paint = paint_ground(scene_.strips[s.item], spot, light);
      break;
    case Material::car:
      paint = paint_car(scene_.cars[s.item], static_cast<int>(s.color.r), spot, light);
      break;
    case Material::roof:
      paint = paint_roof(s.color, s.item == 1, spot, light);
      break;
    case Material::fence:
      paint = paint_fence(s.color, s.item == 1, spot, light);
      break;
    case Material::glow:
      paint = paint_sign(s.color, s.item, spot, light);
      break;
    case Material::plain: {
      const float stripe = spot.u * 1.6F - std::floor(spot.u * 1.6F);
      const float white = s.item == 1 ? inside(stripe, 0.0F, 0.5F, spot.du * 1.6F) : 0.0F;
      paint.albedo = mix(s.color, Color{0.75F, 0.73F, 0.68F}, 0.8F * white);
      if (s.item == 1) paint.albedo = mix(paint.albedo, {0.85F, 0.87F, 0.9F}, light.snow * 0.7F);
      break;
    }
  }
  // Walls are darker near the ground, where less of the sky is seen.
  const float sky =
      s.material == Material::facade ? 0.62F + 0.38F * smooth(0.0F, 9.0F, spot.v) : g_.open[i];
  Color c = paint.albedo * (light.ambient * sky + light.sun * (sun * g_.sun[i])) + paint.glow;
  const float clear = std::exp(-light.fog_density * depth);
  return mix(light.fog, c, clear);
}

void Renderer::draw_sprite(const Sprite& s) {
  const Camera& camera = scene_.camera;
  const Light& light = *scene_.light;
  const auto scale = static_cast<float>(camera.focal / s.foot.z);
  const float w = s.width * scale;
  const float h = s.height * scale;
  const float left =
      static_cast<float>(camera.cx) + static_cast<float>(s.foot.x) * scale - 0.5F * w;
  const float bottom = static_cast<float>(camera.cy) + static_cast<float>(s.foot.y) * scale;
  const int x0 = std::max(0, floor_int(std::max(left, -1.0F)));
  const int x1 = std::min(g_.width, floor_int(std::min(left + w, 1e6F)) + 1);
  const int y0 = std::max(0, floor_int(std::max(bottom - h, -1.0F)));
  const int y1 = std::min(g_.height, floor_int(std::min(bottom, 1e6F)) + 1);
  if (x0 >= x1 || y0 >= y1) return;
  const Picture& picture = album_.picture(s, light);
  const int level = Picture::level_for(std::max(w, 0.6F * h));
  const bool flip = (s.seed & 64U) != 0U && s.thing != Thing::lamp;
  const auto near = static_cast<float>(1.0 / s.foot.z);
  const float clear = std::exp(-light.fog_density * static_cast<float>(s.foot.z));
  for (int y = y0; y < y1; ++y) {
    const float ty = 1.0F - (bottom - static_cast<float>(y) - 0.5F) / h;
    if (ty < 0.0F || ty > 1.0F) continue;
    for (int x = x0; x < x1; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(g_.width) +
                            static_cast<std::size_t>(x);
      if (g_.near[i] > near) continue;
      float tx = (static_cast<float>(x) + 0.5F - left) / w;
      if (tx < 0.0F || tx > 1.0F) continue;
      if (flip) tx = 1.0F - tx;
      const Texel t = picture.at(tx, ty, level);
      if (t.alpha < 0.02F) continue;
      const Color c = mix(light.fog, sprite_color(s, t, light), clear);
      picture_[i] = mix(picture_[i], c, t.alpha);
    }
  }
}

}  // namespace seqloop::street
