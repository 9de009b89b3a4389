// SPDX-License-Identifier: MIT
// Cars, roofs, fences and hanging signs.
#include "shade.hpp"

namespace seqloop::street {

Paint paint_car(const CarPaint& car, int panel, Spot p, const Light& light) {
  const float len = car.length;
  const float belt = car.van ? 1.15F : 0.88F;
  const Color glass = Color{0.03F, 0.035F, 0.04F} + light.sky_low * 0.06F;
  Paint paint{car.body, light.sky_low * 0.05F};
  switch (panel) {
    case 1:  // back: lamps, number plate, bumper
    case 2: {
      const float wide = car.van ? 1.9F : 1.72F;
      const float lamp =
          inside(p.v, 0.32F, 0.55F, p.dv) * (1.0F - inside(p.u, 0.34F, wide - 0.34F, p.du));
      const Color bulb = panel == 1 ? Color{0.55F, 0.02F, 0.02F} : Color{0.85F, 0.83F, 0.75F};
      paint.albedo = mix(paint.albedo, bulb, lamp);
      if (panel == 2) paint.glow = Color{2.2F, 2.0F, 1.5F} * (lamp * light.lamps);
      const float plate = inside(p.u, 0.5F * wide - 0.28F, 0.5F * wide + 0.28F, p.du) *
                          inside(p.v, 0.16F, 0.3F, p.dv);
      paint.albedo =
          mix(paint.albedo * (p.v < 0.14F ? 0.4F : 1.0F), Color{0.8F, 0.8F, 0.7F}, plate);
      break;
    }
    case 3:
      paint.albedo = glass;
      break;
    case 4:
      paint.albedo = mix(car.body, Color{0.85F, 0.87F, 0.9F}, light.snow * 0.85F);
      break;
    default: {
      const float high = inside(p.v, belt, car.height - 0.1F, p.dv) *
                         inside(p.u, 0.28F, car.van ? len * 0.8F : len * 0.7F, p.du);
      const float post = inside(p.u, len * 0.4F, len * 0.43F, p.du);
      const bool blind = car.van && p.u < len * 0.5F;
      if (!blind) paint.albedo = mix(paint.albedo, glass, high * (1.0F - post));
      for (const float hub : {0.19F * len, 0.81F * len}) {
        const float x = p.u - hub;
        const float y = p.v - 0.32F;
        const float r = std::sqrt(x * x + y * y);
        const float soft = std::max(p.du, p.dv);
        paint.albedo = mix(paint.albedo, Color{0.02F, 0.02F, 0.02F}, inside(r, -1.0F, 0.33F, soft));
        paint.albedo = mix(paint.albedo, Color{0.4F, 0.4F, 0.4F}, inside(r, -1.0F, 0.17F, soft));
      }
      break;
    }
  }
  return paint;
}

Paint paint_roof(Color tiles, bool level, Spot p, const Light& light) {
  const float row = p.v * 3.0F - std::floor(p.v * 3.0F);
  const float fade = 1.0F - smooth(0.12F, 0.33F, p.dv);
  const float moss = noise(p.u * 0.6F, p.v * 0.6F, 71U);
  const float tone = 0.8F + 0.4F * moss - fade * 0.25F * inside(row, 0.0F, 0.2F, p.dv * 3.0F);
  const float lying = light.snow * (level ? 1.0F : smooth(0.12F, 0.4F, moss));
  return {mix(tiles * tone, Color{0.85F, 0.86F, 0.9F}, lying), {}};
}

Paint paint_fence(Color color, bool hedge, Spot p, const Light& light) {
  if (hedge) {
    const float leaf = noise(p.u * 4.0F, p.v * 4.0F, 72U);
    const float lying = light.snow * smooth(0.45F, 0.6F, noise(p.u * 2.0F, p.v * 3.0F, 73U));
    return {mix(color * (0.5F + leaf), Color{0.85F, 0.87F, 0.9F}, lying), {}};
  }
  const float board = p.u * 5.0F;
  const float fade = 1.0F - smooth(0.08F, 0.25F, p.du);
  const float gap = inside(board - std::floor(board), 0.0F, 0.25F, p.du * 5.0F) * fade;
  const float tone = 0.8F + 0.4F * noise(p.u * 0.8F, p.v * 2.0F, 74U);
  return {color * (tone * (1.0F - 0.6F * gap)), {}};
}

Paint paint_sign(Color color, std::uint32_t seed, Spot p, const Light& light) {
  const float ink = lattice_unit(floor_int(p.u * 5.0F), floor_int(p.v * 5.0F), seed);
  const Color c = mix(color, Color{0.9F, 0.9F, 0.85F}, ink > 0.62F ? 0.9F : 0.0F);
  return {c, c * (0.9F * light.lamps)};
}

}  // namespace seqloop::street
