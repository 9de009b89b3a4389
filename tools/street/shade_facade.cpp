// SPDX-License-Identifier: MIT
// Fronts of houses: cladding, windows, doors, shops, balconies.
#include "shade.hpp"

namespace seqloop::street {
namespace {

Color clad(const Facade& f, Spot p) {
  const float stain = noise(p.u * 0.35F, p.v * 0.22F, f.seed) - 0.5F;
  const float streak = noise(p.u * 2.1F, p.v * 0.12F, f.seed + 3U) - 0.5F;
  float tone = 1.0F + 0.35F * stain + 0.16F * streak;
  switch (f.cladding) {
    case Cladding::brick: {
      constexpr float kRow = 0.16F;
      constexpr float kLong = 0.46F;
      const float y = p.v / kRow;
      const std::int32_t row = floor_int(y);
      const float x = p.u / kLong + ((row & 1) != 0 ? 0.5F : 0.0F);
      const float fade = 1.0F - smooth(0.1F, 0.32F, std::max(p.dv, p.du * 0.4F));
      if (fade > 0.0F) {
        tone += fade * 0.5F * (lattice_unit(floor_int(x), row, f.seed) - 0.5F);
        const float joint =
            1.0F - inside(y - static_cast<float>(row), 0.12F, 1.0F, std::max(0.05F, p.dv / kRow));
        tone *= 1.0F + fade * 0.35F * joint;
      }
      break;
    }
    case Cladding::panels: {
      const float x = p.u * 0.42F;
      const float y = p.v * 0.33F;
      const std::int32_t i = floor_int(x);
      const std::int32_t j = floor_int(y);
      tone += 0.3F * (lattice_unit(i, j, f.seed) - 0.5F);
      const float joint = inside(x - static_cast<float>(i), 0.0F, 0.04F, p.du * 0.42F) +
                          inside(y - static_cast<float>(j), 0.0F, 0.04F, p.dv * 0.33F);
      tone *= 1.0F - 0.5F * std::min(1.0F, joint);
      break;
    }
    case Cladding::boards: {
      const float x = p.u * 4.5F;
      const float fade = 1.0F - smooth(0.1F, 0.3F, p.du);
      tone += 0.4F * fade * (lattice_unit(floor_int(x), 0, f.seed) - 0.5F);
      break;
    }
    case Cladding::stone: {
      const float y = p.v * 1.7F;
      const std::int32_t row = floor_int(y);
      const float x = p.u * 1.1F + 0.37F * static_cast<float>(row);
      const float fade = 1.0F - smooth(0.3F, 0.8F, std::max(p.dv, p.du * 0.6F));
      tone += 0.45F * fade * (lattice_unit(floor_int(x), row, f.seed) - 0.5F);
      break;
    }
    case Cladding::plaster:
      tone += 0.12F * (noise(p.u * 3.0F, p.v * 3.0F, f.seed + 9U) - 0.5F);
      break;
  }
  return f.wall * std::max(0.2F, tone);
}

/// What is seen in a pane: the dark of a room, a curtain, the sky's mirror image, a lamp.
Paint pane(float y, std::uint32_t key, const Light& light, std::uint64_t traffic) {
  const float curtain = static_cast<float>(key & 0xffU) / 255.0F;
  const float mirror = 0.10F + 0.30F * y;
  Color glass = light.sky_low * (mirror * 0.5F);
  if (curtain > 0.55F) glass = mix(glass, Color{0.55F, 0.53F, 0.48F}, 0.6F * (curtain - 0.3F));
  Paint p{Color{0.05F, 0.06F, 0.07F} + glass * 0.4F, glass * 0.35F};
  const auto mood = static_cast<std::uint32_t>(hash_of(traffic, key) & 0xffffU);
  // Some rooms are lit in every drive, others not: habits, and the day's chance.
  const float lit =
      0.5F * static_cast<float>(key >> 16U) / 65535.0F + 0.5F * static_cast<float>(mood) / 65535.0F;
  if (lit < light.lit_windows && light.lamps > 0.0F) {
    const Color lamp = mix(Color{0.95F, 0.62F, 0.26F}, Color{0.8F, 0.85F, 0.9F}, curtain * 0.6F);
    p.glow = p.glow + lamp * (light.lamps * (0.35F + 0.4F * curtain));
  }
  return p;
}

Paint shop_front(const Facade& f, Spot p, Paint paint, const Light& light) {
  const float sign0 = f.ground_height - 0.75F;
  const float in_sign =
      inside(p.v, sign0, f.ground_height - 0.1F, p.dv) * inside(p.u, 0.25F, f.width - 0.25F, p.du);
  if (in_sign > 0.0F) {
    const float x = (p.u - 0.6F) * 2.6F;
    const float letter = lattice_unit(floor_int(x), 1, f.seed + 40U);
    const float ink = letter > 0.3F ? inside(p.v, sign0 + 0.15F, f.ground_height - 0.25F, p.dv) *
                                          inside(x - static_cast<float>(floor_int(x)), 0.15F,
                                                 0.5F + 0.5F * letter, p.du * 2.6F)
                                    : 0.0F;
    const Color board = mix(f.accent, Color{0.85F, 0.83F, 0.78F} + f.accent * -0.4F, ink);
    paint.albedo = mix(paint.albedo, board, in_sign);
    paint.glow = paint.glow + board * (in_sign * light.lamps * 0.55F);
  }
  const float bay = f.width / std::max(1.0F, std::floor(f.width / 2.8F));
  const float x = p.u - bay * std::floor(p.u / bay);
  const auto key = lattice(floor_int(p.u / bay), 0, f.seed + 11U);
  const float glass = inside(p.v, 0.45F, sign0 - 0.12F, p.dv) * inside(x, 0.14F, bay - 0.14F, p.du);
  if (glass > 0.0F) {
    // Goods in rows on shelves, some of them in the shop's own colour.
    const std::int32_t across = floor_int(x * 1.9F);
    const std::int32_t shelf = floor_int(p.v * 1.4F);
    const float goods = lattice_unit(across, shelf, key);
    const float fill =
        inside(x * 1.9F - static_cast<float>(across), 0.08F, 0.35F + 0.6F * goods, p.du * 1.9F) *
        inside(p.v * 1.4F - static_cast<float>(shelf), 0.0F, 0.3F + 0.6F * goods, p.dv * 1.4F);
    const Color item = goods > 0.6F ? f.accent * 0.7F : Color{0.34F, 0.31F, 0.27F} * (0.4F + goods);
    const Color shown = mix(Color{0.06F, 0.06F, 0.07F}, item, fill);
    paint.albedo = mix(paint.albedo, shown, glass);
    paint.glow = paint.glow + Color{0.75F, 0.68F, 0.52F} *
                                  (glass * light.lamps * (0.40F - 0.28F * fill * goods));
  }
  return paint;
}

}  // namespace

Paint paint_facade(const Facade& f, Spot p, const Light& light, std::uint64_t traffic) {
  Paint paint{clad(f, p), {}};
  if (f.bands && f.front) {
    const float base = inside(p.v, 0.0F, 0.6F, p.dv);
    const float cornice = inside(p.v, f.height - 0.5F, f.height + 0.1F, p.dv);
    const float belt = inside(p.v, f.ground_height - 0.1F, f.ground_height + 0.18F, p.dv);
    paint.albedo = mix(paint.albedo, f.trim, std::max(cornice, belt));
    paint.albedo = paint.albedo * (1.0F - 0.35F * base);
  }
  if (!f.front) {
    // Flanks are mostly blind; some carry a painted advertisement.
    if ((f.seed & 3U) == 0U) {
      const float board = inside(p.u, 1.2F, f.width - 1.2F, p.du) *
                          inside(p.v, f.height * 0.35F, f.height * 0.85F, p.dv);
      const float shape = noise(p.u * 0.9F, p.v * 0.9F, f.seed);
      const Color picture = mix(f.accent, f.trim, inside(shape, 0.38F, 0.6F, 0.05F));
      paint.albedo = mix(paint.albedo, picture, board * 0.85F);
      return paint;
    }
    if ((f.seed & 3U) != 1U) return paint;
  }
  if (p.v < f.ground_height && f.front && f.ground == GroundFloor::shop) {
    return shop_front(f, p, paint, light);
  }
  if (p.v < f.ground_height && f.front) {
    const float wide = f.ground == GroundFloor::garage ? 2.5F : 1.0F;
    const float door = inside(p.u, f.door, f.door + wide, p.du) * inside(p.v, 0.1F, 2.2F, p.dv);
    const float around =
        inside(p.u, f.door - 0.16F, f.door + wide + 0.16F, p.du) * inside(p.v, 0.0F, 2.36F, p.dv);
    if (around > 0.0F) {
      const float slats =
          0.85F + 0.15F * inside(p.v * 3.0F - std::floor(p.v * 3.0F), 0.2F, 0.9F, p.dv * 3.0F);
      paint.albedo = mix(paint.albedo, f.trim, around);
      paint.albedo = mix(paint.albedo, f.accent * slats, door);
      return paint;
    }
  }
  const bool below = p.v < f.ground_height;
  const float level = below ? 0.0F : (p.v - f.ground_height) / f.floor_height;
  const std::int32_t j = below ? -1 : floor_int(level);
  const float height = below ? f.ground_height : f.floor_height;
  const float y = below ? p.v : (level - static_cast<float>(j)) * f.floor_height;
  const float x0 = p.u - f.margin;
  const std::int32_t i = floor_int(x0 / f.bay);
  const float x = x0 - static_cast<float>(i) * f.bay;
  const float top_left = f.height - p.v + y;
  if (x0 < 0.0F || p.u > f.width - f.margin || top_left < height * 0.9F) return paint;
  const std::uint32_t key = lattice(i, j, f.seed + 21U);
  if ((key % 11U) == 0U) return paint;  // bricked up
  // Columns of windows differ a little, so that a long front is not the same everywhere.
  const float column = lattice_unit(i, 77, f.seed);
  if (column < 0.10F) return paint;
  const float half = 0.5F * std::min(f.window_width * (0.65F + 0.6F * column), f.bay - 0.25F);
  const float centre = 0.5F * f.bay;
  const float sill = std::max(0.25F, 0.55F * (height - f.window_height));
  float head = std::min(height - 0.15F, sill + f.window_height);
  if (f.arched) head -= 0.35F * half * ((x - centre) / half) * ((x - centre) / half);
  const float frame = inside(x, centre - half - 0.14F, centre + half + 0.14F, p.du) *
                      inside(y, sill - 0.16F, head + 0.16F, p.dv);
  paint.albedo = mix(paint.albedo, f.trim, frame);
  if (f.shutters) {
    const float wing = half * 0.75F;
    const float both = inside(x, centre - half - wing, centre + half + wing, p.du) *
                       inside(y, sill, head, p.dv) *
                       (1.0F - inside(x, centre - half, centre + half, p.du));
    paint.albedo = mix(paint.albedo, f.accent * 0.7F, both);
  }
  float glass = inside(x, centre - half, centre + half, p.du) * inside(y, sill, head, p.dv);
  const float bars = inside(x, centre - 0.05F, centre + 0.05F, p.du) +
                     inside(y, mix(sill, head, 0.66F), mix(sill, head, 0.66F) + 0.09F, p.dv);
  glass *= 1.0F - 0.8F * std::min(1.0F, bars);
  if (glass > 0.0F) {
    const Paint in = pane((y - sill) / (head - sill), key, light, traffic);
    paint.albedo = mix(paint.albedo, in.albedo, glass);
    paint.glow = paint.glow + in.glow * glass;
  }
  const float ledge = inside(x, centre - half - 0.2F, centre + half + 0.2F, p.du) *
                      inside(y, sill - 0.2F, sill - 0.03F, p.dv);
  paint.albedo = mix(paint.albedo, Color{0.85F, 0.87F, 0.9F}, ledge * light.snow);
  if (!below && f.front && ((f.balconies >> (static_cast<std::uint32_t>(i) & 31U)) & 1U) != 0U) {
    const float slab = inside(y, 0.0F, 0.16F, p.dv);
    const float rail = inside(y, 0.16F, 1.05F, p.dv) * inside(x, 0.1F, f.bay - 0.1F, p.du);
    const float under = inside(y, height - 0.5F, height, p.dv);
    paint.albedo = paint.albedo * (1.0F - 0.4F * under);
    paint.albedo = mix(paint.albedo, f.trim * 0.55F, rail * 0.75F);
    paint.albedo = mix(paint.albedo, mix(f.trim, Color{0.9F, 0.9F, 0.9F}, light.snow), slab);
  }
  return paint;
}

}  // namespace seqloop::street
