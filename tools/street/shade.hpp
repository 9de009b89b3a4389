// SPDX-License-Identifier: MIT
// Colours of points on surfaces: procedural textures, no stored pictures.
#pragma once

#include "scene.hpp"

namespace seqloop::street {

/// A point on a surface: metres, and the width of a pixel there in metres.
struct Spot {
  float u{}, v{};
  float du{}, dv{};
};

/// What a surface does with light at a spot: reflects a share, and gives out some of its own.
struct Paint {
  Color albedo;
  Color glow;
};

Paint paint_facade(const Facade& facade, Spot spot, const Light& light, std::uint64_t traffic);
Paint paint_ground(const Strip& strip, Spot spot, const Light& light);
Paint paint_car(const CarPaint& car, int panel, Spot spot, const Light& light);
Paint paint_roof(Color tiles, bool level, Spot spot, const Light& light);
Paint paint_fence(Color color, bool hedge, Spot spot, const Light& light);
Paint paint_sign(Color color, std::uint32_t seed, Spot spot, const Light& light);

}  // namespace seqloop::street
