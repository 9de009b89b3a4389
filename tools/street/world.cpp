// SPDX-License-Identifier: MIT
#include "world.hpp"

#include <cmath>

namespace seqloop::street {
namespace {

enum class Use : std::uint8_t { terrace, houses, block, park };

struct Plot {
  std::int64_t cell;
  int side;
  double begin, end;
  int style;
};

Building make_building(Dice& dice, const Plot& plot, double begin, double end, double height) {
  Building b;
  b.side = plot.side;
  b.begin = begin;
  b.end = end;
  b.height = height;
  b.depth = dice.range(8.0, 12.0);
  b.front = make_facade(dice, plot.style, end - begin, height);
  b.flank = make_facade(dice, plot.style, b.depth, height);
  b.flank.wall = b.front.wall * dice.rangef(0.75F, 1.0F);
  b.flank.trim = b.front.trim;
  b.flank.cladding = b.front.cladding;
  b.flank.front = false;
  b.flank.balconies = 0;
  b.roof = mix(Color{0.33F, 0.12F, 0.07F}, Color{0.13F, 0.13F, 0.15F}, dice.rangef(0.0F, 1.0F));
  b.chimney = dice.chance(0.5);
  b.hanging_sign = dice.chance(b.front.ground == GroundFloor::shop ? 0.55 : 0.12);
  b.awning = b.front.ground == GroundFloor::shop && dice.chance(0.5);
  return b;
}

void add_terrace(Dice& dice, const Plot& plot, Cell& cell) {
  const int count = 2 + dice.below(4);
  double at = plot.begin;
  const double base = dice.range(7.0, 14.0);
  const double setback = dice.chance(0.3) ? dice.range(0.5, 2.5) : 0.0;
  for (int i = 0; i < count; ++i) {
    const double mean = (plot.end - at) / (count - i);
    const double end = i + 1 == count ? plot.end : at + mean * dice.range(0.65, 1.35);
    Building b = make_building(dice, plot, at, end, base + dice.range(-2.5, 4.0));
    b.setback = setback;
    b.ridge = dice.chance(0.7) ? dice.range(2.0, 4.0) : 0.0;
    if (!dice.chance(0.08)) cell.buildings.push_back(b);
    at = end;
  }
}

void add_garden(Dice& dice, double begin, double end, int side, Cell& cell) {
  const int count = 1 + dice.below(3);
  for (int i = 0; i < count; ++i) {
    const Thing kinds[3] = {Thing::broadleaf, Thing::conifer, Thing::bush};
    const Thing thing = kinds[dice.below(3)];
    const double height = thing == Thing::bush ? dice.range(0.8, 2.0) : dice.range(4.0, 9.0);
    cell.props.push_back({thing, static_cast<std::uint32_t>(dice.bits()), dice.range(begin, end),
                          side * dice.range(9.8, 13.0), height * dice.range(0.55, 0.95), height});
  }
}

void add_houses(Dice& dice, const Plot& plot, Cell& cell) {
  const int count = 2 + dice.below(2);
  const double lot = (plot.end - plot.begin) / count;
  for (int i = 0; i < count; ++i) {
    const double begin = plot.begin + lot * i + dice.range(1.5, 4.0);
    const double end = plot.begin + lot * (i + 1) - dice.range(1.0, 4.0);
    Building b = make_building(dice, plot, begin, end, dice.range(3.2, 6.5));
    b.setback = dice.range(2.5, 7.0);
    b.ridge = dice.range(2.2, 4.5);
    cell.buildings.push_back(b);
    add_garden(dice, plot.begin + lot * i, begin, plot.side, cell);
  }
  const bool hedge = dice.chance(0.5);
  const Color paint =
      hedge ? Color{0.07F, 0.15F, 0.04F} : Color{0.5F, 0.45F, 0.38F} * dice.rangef(0.4F, 1.4F);
  const double gate = dice.range(plot.begin + 4.0, plot.end - 8.0);
  const double height = dice.range(0.7, 1.6);
  const double d = plot.side * (kFacadeLine + 0.3);
  cell.fences.push_back({plot.begin, gate, d, height, paint, hedge});
  cell.fences.push_back({gate + 3.0, plot.end, d, height, paint, hedge});
}

void add_block(Dice& dice, const Plot& plot, Cell& cell) {
  const double begin = plot.begin + dice.range(0.0, 8.0);
  const double end = plot.end - dice.range(0.0, 10.0);
  Building b = make_building(dice, plot, begin, end, dice.range(11.0, 26.0));
  b.setback = dice.range(0.0, 6.0);
  cell.buildings.push_back(b);
  if (b.setback > 2.0) add_garden(dice, begin, end, plot.side, cell);
}

void add_park(Dice& dice, const Plot& plot, Cell& cell) {
  const int count = 4 + dice.below(6);
  for (int i = 0; i < count; ++i) {
    const Thing thing = dice.chance(0.25) ? Thing::conifer : Thing::broadleaf;
    const double height = dice.range(5.0, 13.0);
    cell.props.push_back({thing, static_cast<std::uint32_t>(dice.bits()),
                          dice.range(plot.begin, plot.end), plot.side * dice.range(10.0, 30.0),
                          height * dice.range(0.6, 0.95), height});
  }
  const double d = plot.side * (kFacadeLine + 0.2);
  const bool hedge = dice.chance(0.4);
  const Color paint =
      (hedge ? Color{0.07F, 0.15F, 0.04F} : Color{0.28F, 0.27F, 0.25F}) * dice.rangef(0.6F, 1.4F);
  cell.fences.push_back({plot.begin, plot.end, d, dice.range(0.6, 1.8), paint, hedge});
}

void add_street_props(Dice& dice, const Plot& plot, bool avenue, Cell& cell) {
  const double side = plot.side;
  if (avenue) {
    const double pitch = dice.range(9.0, 17.0);
    for (double s = plot.begin + dice.range(1.0, 6.0); s < plot.end; s += pitch) {
      const double height = dice.range(4.5, 9.0);
      cell.props.push_back({Thing::broadleaf, static_cast<std::uint32_t>(dice.bits()),
                            s + dice.range(-1.5, 1.5), side * dice.range(6.2, 7.2),
                            height * dice.range(0.5, 0.85), height});
    }
  }
  cell.props.push_back({Thing::lamp, static_cast<std::uint32_t>(dice.bits() & 0xffU),
                        plot.begin + (plot.side > 0 ? 6.0 : 27.0), side * 5.8, 1.6, 6.5});
  if (dice.chance(0.55)) {
    cell.props.push_back({Thing::pole_sign, static_cast<std::uint32_t>(dice.bits()),
                          dice.range(plot.begin, plot.end), side * 5.7, 0.8, 2.7});
  }
  if (dice.chance(0.3)) {
    cell.props.push_back({Thing::bush, static_cast<std::uint32_t>(dice.bits()),
                          dice.range(plot.begin, plot.end), side * 8.0, 1.6, 1.3});
  }
}

}  // namespace

bool World::crossing(std::int64_t k) const noexcept {
  return unit(hash_of(seed_, 0x63726f73, k)) < 0.36;
}

Cell World::cell(std::int64_t k) const {
  Cell cell;
  cell.crossing = crossing(k);
  const auto district = static_cast<std::int64_t>(std::floor(static_cast<double>(k) / 5.0));
  Dice quarter(hash_of(seed_, 0x64697374, district));
  const int style = quarter.below(5);
  const double houses = style == 3 ? 0.6 : 0.18;
  const double blocks = style == 2 ? 0.55 : 0.12;
  const bool leafy = quarter.chance(0.5);
  Dice ground(hash_of(seed_, 0x67726f75, k));
  cell.paving = Color{0.36F, 0.34F, 0.32F} * ground.rangef(0.65F, 1.25F);
  cell.verge = ground.chance(0.5) ? Color{} : Color{0.30F, 0.28F, 0.26F};
  for (const int side : {1, -1}) {
    Dice dice(hash_of(seed_, 0x63656c6c, k, side));
    const double start = static_cast<double>(k) * kCell;
    Plot plot{k, side, start + (cell.crossing ? kCrossing : 0.0), start + kCell, style};
    if (!cell.crossing && dice.chance(0.15)) plot.begin += dice.range(3.0, 9.0);
    const double roll = dice.range(0.0, 1.0);
    if (roll < 0.10) {
      add_park(dice, plot, cell);
    } else if (roll < 0.10 + houses * 0.9) {
      add_houses(dice, plot, cell);
    } else if (roll < 0.10 + (houses + blocks) * 0.9) {
      add_block(dice, plot, cell);
    } else {
      add_terrace(dice, plot, cell);
    }
    add_street_props(dice, plot, dice.chance(leafy ? 0.7 : 0.15), cell);
  }
  return cell;
}

}  // namespace seqloop::street
