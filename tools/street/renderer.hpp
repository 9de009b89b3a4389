// SPDX-License-Identifier: MIT
// One shot to one picture: scene, pixels, shading, sprites, camera.
#pragma once

#include <opencv2/core.hpp>

#include "raster.hpp"
#include "scene.hpp"
#include "sprites.hpp"

namespace seqloop::street {

/// Draws shots of one world at one size. Same shot, same picture, byte for byte.
class Renderer {
 public:
  /// @param width, height pixels, 16 or more each.
  Renderer(const Path& path, int width, int height);

  /// @param image becomes height x width, 8-bit BGR. Allocates: the scene's lists, which keep
  /// their memory; nothing that grows with the drive.
  void render(const Shot& shot, cv::Mat& image);

 private:
  void draw_shadows();
  void shade();
  Color shade_pixel(std::size_t i, int x, int y) const;
  void draw_sprite(const Sprite& sprite);

  const Path& path_;
  World world_;
  Album album_;
  GBuffer g_;
  Scene scene_;
  std::vector<Color> picture_;
};

/// Fills those pixels that show nothing else with sky, clouds and hills.
/// @param heading absolute heading of the layout frame, rad. @param street seed of its hills; the
/// clouds are the shot's.
void shade_sky(const Camera& camera, const Shot& shot, double heading, std::uint64_t street,
               const GBuffer& g, std::vector<Color>& picture);

/// Lens and sensor: vignette, white balance, exposure, tone curve, noise.
void develop(const std::vector<Color>& picture, const Light& light, std::uint64_t noise,
             cv::Mat& image);

}  // namespace seqloop::street
