// SPDX-License-Identifier: MIT
#include "sprites.hpp"

#include <cmath>

namespace seqloop::street {
namespace {

void grow(Picture& picture, Dice& dice, double x, double y, double angle, double size, double wide,
          int depth, std::vector<Corner>& tips) {
  // Crowns stay inside the picture: a branch that would leave it turns back or stays short.
  if (std::fabs(x + size * std::sin(angle) - 0.5) > 0.40) angle *= -0.5;
  if (y + size * std::cos(angle) > 0.93) size *= 0.4;
  const double x1 = x + size * std::sin(angle);
  const double y1 = y + size * std::cos(angle);
  picture.line(x, y, x1, y1, wide, wide * 0.7, {1.0F, dice.rangef(0.35F, 0.6F), 0.0F, 0.0F});
  if (depth == 0) {
    tips.push_back({x1, y1});
    return;
  }
  const int forks = depth > 3 ? 2 + dice.below(2) : 2;
  for (int i = 0; i < forks; ++i) {
    const double spread = dice.range(-0.75, 0.75) + (i - 0.5 * (forks - 1)) * 0.5;
    grow(picture, dice, x1, y1, 0.85 * angle + spread, size * dice.range(0.62, 0.86), wide * 0.62,
         depth - 1, tips);
  }
}

}  // namespace

Picture draw_tree(std::uint64_t seed, bool leaves) {
  Picture picture;
  Dice wood(hash_of(seed, 1));
  std::vector<Corner> tips;
  const double lean = wood.range(-0.08, 0.08);
  grow(picture, wood, 0.5, 0.0, lean, wood.range(0.22, 0.30), 0.05, 5, tips);
  if (leaves) {
    Dice dice(hash_of(seed, 2));
    for (int pass = 0; pass < 4; ++pass) {
      for (const Corner& tip : tips) {
        const double x = tip.u + dice.range(-0.11, 0.11);
        const double y = tip.v + dice.range(-0.09, 0.07);
        const float tone = 0.08F + 0.07F * static_cast<float>(pass) +
                           0.30F * static_cast<float>(y) + dice.rangef(-0.08F, 0.10F);
        const double r = std::min({dice.range(0.015, 0.05), x, 1.0 - x, 1.0 - y});
        if (r > 0.005) picture.disc(x, y, r, {0.95F, tone, 1.0F, 0.0F});
      }
    }
  }
  picture.finish();
  return picture;
}

Picture draw_conifer(std::uint64_t seed) {
  Picture picture;
  Dice dice(hash_of(seed, 3));
  picture.line(0.5, 0.0, 0.5, 0.9, 0.05, 0.01, {1.0F, 0.35F, 0.0F, 0.0F});
  const double wide = dice.range(0.28, 0.46);
  for (int i = 0; i < 420; ++i) {
    const double y = dice.range(0.1, 0.98);
    const double reach = wide * (1.02 - y) * (0.75 + 0.25 * std::cos(y * 42.0));
    const double x = 0.5 + reach * dice.range(-1.0, 1.0);
    const float tone = 0.25F + dice.rangef(0.0F, 0.3F) + (i % 5 == 0 ? 0.15F : 0.0F);
    picture.line(x, y, x + (x - 0.5) * 0.25, y - 0.04, 0.022, 0.01, {1.0F, tone, 1.0F, 0.0F});
  }
  picture.finish();
  return picture;
}

Picture draw_bush(std::uint64_t seed) {
  Picture picture;
  Dice dice(hash_of(seed, 4));
  for (int i = 0; i < 160; ++i) {
    const double angle = dice.range(0.0, kPi);
    const double r = std::sqrt(dice.range(0.0, 1.0));
    const double y = 0.78 * r * std::sin(angle) + 0.03;
    const float tone = 0.25F + 0.4F * static_cast<float>(y) + dice.rangef(-0.1F, 0.15F);
    picture.disc(0.5 + 0.44 * r * std::cos(angle), y, dice.range(0.02, 0.07),
                 {0.9F, tone, 1.0F, 0.0F});
  }
  picture.finish();
  return picture;
}

Picture draw_lamp() {
  Picture picture;
  picture.line(0.2, 0.0, 0.2, 0.92, 0.09, 0.05, {1.0F, 0.4F, 0.0F, 0.0F});
  picture.line(0.2, 0.92, 0.75, 0.97, 0.03, 0.02, {1.0F, 0.4F, 0.0F, 0.0F});
  picture.box(0.55, 0.94, 0.9, 0.97, {1.0F, 0.7F, 0.0F, 1.0F});
  picture.finish();
  return picture;
}

Picture draw_pole_sign(std::uint64_t seed) {
  Picture picture;
  Dice dice(hash_of(seed, 5));
  picture.line(0.5, 0.0, 0.5, 0.95, 0.08, 0.08, {1.0F, 0.5F, 0.0F, 0.0F});
  if (dice.chance(0.5)) {
    picture.box(0.05, 0.62, 0.95, 0.98, {1.0F, 0.95F, 1.0F, 0.0F});
    picture.box(0.12, 0.65, 0.88, 0.95, {1.0F, 0.45F, 1.0F, 0.0F});
  } else {
    picture.box(0.1, 0.8, 0.9, 1.0, {1.0F, 0.5F, 1.0F, 0.0F});
    picture.box(0.15, 0.5, 0.85, 0.72, {1.0F, 0.9F, 1.0F, 0.0F});
  }
  picture.finish();
  return picture;
}

Picture draw_person(std::uint64_t seed) {
  Picture picture;
  Dice dice(hash_of(seed, 6));
  const double stride = dice.range(0.04, 0.14);
  picture.line(0.5, 0.48, 0.5 - stride, 0.0, 0.13, 0.1, {1.0F, 0.2F, 0.0F, 0.0F});
  picture.line(0.5, 0.48, 0.5 + stride, 0.0, 0.13, 0.1, {1.0F, 0.25F, 0.0F, 0.0F});
  picture.line(0.5, 0.48, 0.5, 0.78, 0.3, 0.24, {1.0F, 0.5F, 1.0F, 0.0F});
  picture.disc(0.5, 0.91, 0.07, {1.0F, 0.75F, 0.0F, 0.0F});
  picture.finish();
  return picture;
}

Album::Album() : lamp_(draw_lamp()) {
  for (std::size_t i = 0; i < kTrees; ++i) {
    leafy_[i] = draw_tree(100U + i, true);
    bare_[i] = draw_tree(100U + i, false);
  }
  for (std::size_t i = 0; i < kOthers; ++i) {
    conifers_[i] = draw_conifer(200U + i);
    bushes_[i] = draw_bush(300U + i);
    signs_[i] = draw_pole_sign(400U + i);
    people_[i] = draw_person(500U + i);
  }
}

const Picture& Album::picture(const Sprite& s, const Light& light) const noexcept {
  const std::size_t tree = s.seed % kTrees;
  const std::size_t other = s.seed % kOthers;
  switch (s.thing) {
    case Thing::broadleaf:
      return light.leaves > 0.5F ? leafy_[tree] : bare_[tree];
    case Thing::conifer:
      return conifers_[other];
    case Thing::bush:
      return bushes_[other];
    case Thing::pole_sign:
      return signs_[other];
    case Thing::person:
      return people_[other];
    case Thing::lamp:
      break;
  }
  return lamp_;
}

Color sprite_color(const Sprite& s, Texel t, const Light& light) noexcept {
  const auto chance = static_cast<float>(mix64(s.seed) & 0xffU) / 255.0F;
  Color tint = light.leaf * (0.7F + 0.6F * chance);
  float snow = 0.35F * light.snow;
  if (s.thing == Thing::conifer) {
    tint = Color{0.05F, 0.12F, 0.06F} * (0.7F + 0.6F * chance);
    snow = light.snow * smooth(0.4F, 0.55F, t.tone);
  } else if (s.thing == Thing::pole_sign || s.thing == Thing::person) {
    const float other = static_cast<float>((mix64(s.seed) >> 8U) & 0xffU) / 255.0F;
    tint = mix(Color{0.05F, 0.12F, 0.42F}, Color{0.55F, 0.06F, 0.05F}, chance > 0.5F ? 1.0F : 0.0F);
    if (other > 0.6F) tint = {0.6F, 0.6F, 0.55F};
    snow = 0.0F;
  }
  const Color wood{0.13F, 0.11F, 0.09F};
  Color c = mix(wood, tint, t.leaf) * (2.0F * t.tone);
  if (s.thing == Thing::broadleaf) snow *= smooth(0.42F, 0.5F, t.tone);
  c = mix(c, Color{0.8F, 0.82F, 0.86F}, snow);
  const Color falling = light.ambient + light.sun * s.sun;
  return c * falling + Color{3.0F, 2.4F, 1.5F} * (t.glow * light.lamps);
}

}  // namespace seqloop::street
