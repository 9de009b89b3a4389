// SPDX-License-Identifier: MIT
// Road, kerb, pavement and what lies behind.
#include "shade.hpp"

namespace seqloop::street {
namespace {

constexpr float kRoad = static_cast<float>(kRoadHalf);
constexpr float kLine = static_cast<float>(kFacadeLine);
constexpr float kSide = static_cast<float>(kCrossing);

Color asphalt(float s, float d, std::uint32_t seed, const Light& light) {
  const float patch = noise(s * 0.11F, d * 0.45F, seed);
  const float grain = noise(s * 1.3F, d * 1.7F, seed + 1U);
  const float repair = smooth(0.72F, 0.75F, noise(s * 0.16F + 40.0F, d * 0.3F, seed + 2U));
  const float tone = (0.10F + 0.07F * patch + 0.05F * (grain - 0.5F)) * (1.0F - 0.4F * repair);
  return Color{tone, tone, tone * 1.03F} * (1.0F - 0.4F * light.wet);
}

}  // namespace

Paint paint_ground(const Strip& strip, Spot p, const Light& light) {
  const float d = p.v;
  const float t = (p.u - d * strip.bend) / (strip.length - 2.0F * d * strip.bend);
  const float local = strip.street + strip.length * clamp01(t);  // metres into the cell
  const float s = local + static_cast<float>(kCell) * static_cast<float>(strip.cell);
  const float side = std::fabs(d);
  const float blur_s = std::max(0.03F, p.du);
  const float blur_d = std::max(0.02F, p.dv);
  const bool in_crossing = strip.crossing && local < kSide;

  const float tone = noise(s * 0.9F, d * 0.9F, strip.seed + 3U);
  Color ground = mix(light.grass * 0.8F, light.grass * 1.3F, tone);
  if (strip.verge.r > 0.0F) ground = strip.verge * (0.8F + 0.4F * tone);
  float snow = light.snow * smooth(0.1F, 0.25F, tone + 0.15F);
  Color c = ground;
  if (in_crossing) {
    c = asphalt(s, d, strip.seed, light);
    snow *= 0.35F + 0.5F * smooth(0.4F, 0.7F, noise(s * 0.5F, d * 0.25F, strip.seed + 4U));
  } else if (side < kLine) {
    const float slab = lattice_unit(floor_int(s * 0.8F), floor_int(d * 1.2F), strip.seed + 5U);
    const float fade = 1.0F - smooth(0.3F, 1.2F, std::max(p.du, p.dv));
    c = strip.paving * (1.0F + 0.22F * fade * (slab - 0.5F) + 0.2F * (tone - 0.5F));
    snow *= 0.75F;
  }
  const float road = inside(d, -kRoad, kRoad, blur_d);
  if (road > 0.0F) {
    Color top = asphalt(s, d, strip.seed, light);
    const float dash = inside(s - 6.0F * std::floor(s / 6.0F), 0.0F, 3.0F, blur_s);
    float white = inside(d, -0.08F, 0.08F, blur_d) * dash;
    white = std::max(white, 0.7F * inside(side, 3.05F, 3.17F, blur_d));
    if (strip.crossing) {
      const float stripe = d - std::floor(d);
      const float zebra = inside(local, kSide + 1.0F, kSide + 4.2F, blur_s) *
                          inside(stripe, 0.0F, 0.5F, blur_d) * inside(side, -1.0F, 4.6F, blur_d);
      const float stop =
          inside(local, kSide + 5.4F, kSide + 5.8F, blur_s) * inside(d, 0.1F, 3.0F, blur_d);
      white = std::max(white * (local < kSide + 6.5F ? 0.0F : 1.0F), std::max(zebra, stop));
    }
    const float worn = 0.55F + 0.45F * noise(s * 1.1F, d * 2.0F, strip.seed + 6U);
    top = mix(top, Color{0.62F, 0.62F, 0.60F}, white * worn);
    const std::int32_t lid = floor_int(s / 17.0F);
    const float lid_s =
        s - 17.0F * static_cast<float>(lid) - 4.0F - 9.0F * lattice_unit(lid, 0, strip.seed + 7U);
    const float lid_d = d - 5.0F * (lattice_unit(lid, 1, strip.seed + 7U) - 0.5F);
    if (lid_s * lid_s + lid_d * lid_d < 0.16F) top = top * 0.5F;
    c = mix(c, top, road);
    // Wheels keep two tracks a lane free of snow.
    const float lane = std::fabs(side - 1.65F);
    const float track = smooth(0.25F, 0.6F, std::fabs(lane - 0.75F));
    const float left_over = smooth(0.3F, 0.7F, noise(s * 0.22F, d * 0.8F, strip.seed + 8U));
    const float on_road = (side > 3.1F ? 0.75F : 0.6F * track) * (0.35F + 0.65F * left_over);
    snow = mix(snow, light.snow * on_road, road);
  }
  if (!in_crossing) {
    const float kerb = inside(side, kRoad, kRoad + 0.22F, blur_d);
    c = mix(c, Color{0.46F, 0.45F, 0.43F}, kerb * 0.8F);
    const float gutter = inside(side, kRoad - 0.35F, kRoad, blur_d);
    c = c * (1.0F - 0.3F * gutter);
  }
  const float drift = 0.72F + 0.16F * noise(s * 0.7F, d * 0.7F, strip.seed + 9U);
  return {mix(c, Color{drift, drift * 1.01F, drift * 1.05F}, clamp01(snow)), {}};
}

}  // namespace seqloop::street
