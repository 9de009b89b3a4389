// SPDX-License-Identifier: MIT
// Chance looks of fronts: colours, floors, windows.
#include "world.hpp"

namespace seqloop::street {
namespace {

Color wall_color(Dice& dice, Cladding cladding) {
  switch (cladding) {
    case Cladding::brick: {
      const Color red{0.36F, 0.13F, 0.08F};
      const Color yellow{0.50F, 0.36F, 0.19F};
      const Color dark{0.17F, 0.12F, 0.11F};
      const Color base = dice.chance(0.55) ? red : (dice.chance(0.6) ? yellow : dark);
      return base * dice.rangef(0.75F, 1.2F);
    }
    case Cladding::panels: {
      const float grey = dice.rangef(0.22F, 0.62F);
      return {grey * dice.rangef(0.9F, 1.08F), grey, grey * dice.rangef(0.9F, 1.1F)};
    }
    case Cladding::boards: {
      const Color bare{0.42F, 0.20F, 0.10F};
      const Color painted{dice.rangef(0.1F, 0.7F), dice.rangef(0.2F, 0.65F),
                          dice.rangef(0.1F, 0.6F)};
      return mix(bare, painted, dice.rangef(0.2F, 1.0F));
    }
    case Cladding::stone:
      return Color{0.48F, 0.43F, 0.35F} * dice.rangef(0.7F, 1.2F);
    case Cladding::plaster:
      break;
  }
  const float value = dice.rangef(0.34F, 0.85F);
  const float warm = dice.rangef(-0.2F, 0.35F);
  const float green = dice.rangef(-0.1F, 0.1F);
  return {value * (1.0F + 0.3F * warm), value * (1.0F + green * 0.6F),
          value * (1.0F - 0.9F * warm)};
}

Color vivid(Dice& dice) {
  const float hue = dice.rangef(0.0F, 6.0F);
  const auto wave = [hue](float at) {
    const float x = std::fabs(std::fmod(hue - at + 9.0F, 6.0F) - 3.0F);
    return 0.04F + 0.55F * clamp01(x - 1.0F);
  };
  return {wave(0.0F), wave(2.0F), wave(4.0F)};
}

}  // namespace

Facade make_facade(Dice& dice, int style, double width, double height) {
  Facade f;
  f.seed = static_cast<std::uint32_t>(dice.bits());
  constexpr Cladding kUsual[5] = {Cladding::stone, Cladding::plaster, Cladding::panels,
                                  Cladding::brick, Cladding::boards};
  f.cladding = dice.chance(0.45) ? kUsual[style] : static_cast<Cladding>(dice.below(4));
  f.wall = wall_color(dice, f.cladding);
  f.trim = dice.chance(0.6) ? Color{0.78F, 0.76F, 0.70F} * dice.rangef(0.6F, 1.1F)
                            : f.wall * dice.rangef(0.35F, 0.6F);
  f.accent = vivid(dice);
  f.width = static_cast<float>(width);
  f.height = static_cast<float>(height);
  const double shop_chance = style == 0 ? 0.6 : (style == 3 ? 0.1 : 0.4);
  f.ground = dice.chance(shop_chance)
                 ? GroundFloor::shop
                 : (dice.chance(0.25) ? GroundFloor::garage : GroundFloor::windows);
  f.ground_height =
      f.ground == GroundFloor::shop ? dice.rangef(3.2F, 4.4F) : dice.rangef(2.7F, 3.3F);
  const float upper = std::max(0.0F, f.height - f.ground_height - 0.3F);
  const float floors = std::max(1.0F, std::floor(upper / dice.rangef(2.6F, 3.7F)));
  f.floor_height = std::max(2.2F, upper / floors);
  const float usable = f.width - 0.8F;
  const float columns = std::max(1.0F, std::floor(usable / dice.rangef(1.7F, 3.6F)));
  f.bay = usable / columns;
  f.margin = 0.4F;
  f.window_width = f.bay * dice.rangef(0.32F, style == 2 ? 0.92F : 0.68F);
  f.window_height = f.floor_height * dice.rangef(0.4F, style == 2 ? 0.8F : 0.66F);
  f.door = dice.rangef(0.1F, 0.8F) * (f.width - 1.2F);
  f.balconies = dice.chance(0.4) ? static_cast<std::uint32_t>(dice.bits() & dice.bits()) : 0U;
  f.shutters = style != 2 && dice.chance(0.3);
  f.arched = style == 0 && dice.chance(0.4);
  f.bands = dice.chance(0.45);
  f.front = true;
  return f;
}

}  // namespace seqloop::street
