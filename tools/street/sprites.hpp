// SPDX-License-Identifier: MIT
// Trees, lamps, signs and people: small drawn pictures with smaller copies for the distance.
#pragma once

#include <array>
#include <vector>

#include "scene.hpp"

namespace seqloop::street {

/// One texel; each value 0..1.
struct Texel {
  float alpha{};  ///< how much it hides
  float tone{};   ///< brightness, 0.5 is the tint itself
  float leaf{};   ///< 0 wood or metal, 1 leaf or paint
  float glow{};   ///< lamp
};

/// A square picture and its halves, quarters and so on; row 0 is the top.
class Picture {
 public:
  static constexpr int kSize = 128;

  Picture() : levels_{std::vector<Texel>(std::size_t{kSize} * kSize)} {}

  /// Disc and thick line in picture units (0..1, y up), over what is there already.
  void disc(double x, double y, double radius, Texel texel);
  void line(double x0, double y0, double x1, double y1, double wide0, double wide1, Texel texel);
  void box(double x0, double y0, double x1, double y1, Texel texel);
  /// Makes the smaller copies; to be called once, after drawing.
  void finish();
  /// @param x, y 0..1, y down. @param pixels how many pixels the picture is wide on screen.
  Texel at(float x, float y, int level) const noexcept;
  static int level_for(float pixels) noexcept;

 private:
  void put(int x, int y, float cover, Texel texel);

  std::vector<std::vector<Texel>> levels_;
};

/// All pictures. The same tree has one skeleton with leaves and without.
class Album {
 public:
  Album();

  const Picture& picture(const Sprite& sprite, const Light& light) const noexcept;

 private:
  static constexpr std::size_t kTrees = 8;
  static constexpr std::size_t kOthers = 4;
  std::array<Picture, kTrees> leafy_, bare_;
  std::array<Picture, kOthers> conifers_, bushes_, signs_, people_;
  Picture lamp_;
};

/// Draws of a broadleaf tree, wood first. @param leaves false for a bare one.
Picture draw_tree(std::uint64_t seed, bool leaves);
Picture draw_conifer(std::uint64_t seed);
Picture draw_bush(std::uint64_t seed);
Picture draw_lamp();
Picture draw_pole_sign(std::uint64_t seed);
Picture draw_person(std::uint64_t seed);

/// Colour of a texel of a sprite under a light, before fog.
Color sprite_color(const Sprite& sprite, Texel texel, const Light& light) noexcept;

}  // namespace seqloop::street
