// SPDX-License-Identifier: MIT
// Sky, clouds, far hills; and what the lens and the sensor make of it all.
#include <cmath>

#include "renderer.hpp"

namespace seqloop::street {
namespace {

/// Height of the horizon's hills over the flat, as a slope. @param azimuth rad.
float hill(float azimuth, float scale, std::uint32_t seed) {
  const float x = azimuth * scale;
  return 0.6F * noise(x, 0.5F, seed) + 0.3F * noise(x * 2.7F, 1.5F, seed) +
         0.1F * noise(x * 7.1F, 2.5F, seed);
}

}  // namespace

void shade_sky(const Camera& camera, const Shot& shot, double heading, std::uint64_t street,
               const GBuffer& g, std::vector<Color>& picture) {
  const Light& light = shot.light;
  const auto land = static_cast<std::uint32_t>(hash_of(street, 0x68696c6c));
  const auto air = static_cast<std::uint32_t>(hash_of(shot.traffic, 0x636c6f75));
  std::vector<float> far_hills(static_cast<std::size_t>(g.width));
  std::vector<float> near_hills(far_hills.size());
  const auto k = static_cast<float>(1.0 / camera.focal);
  const auto row_of = [&](int y) {
    return (static_cast<float>(y) + 0.5F - static_cast<float>(camera.cy)) * k;
  };
  const auto fwd = [](double a) { return static_cast<float>(a); };
  for (int x = 0; x < g.width; ++x) {
    const double c = (x + 0.5 - camera.cx) / camera.focal;
    const Vec3 ray = camera.forward + camera.right * c;
    const auto azimuth = static_cast<float>(wrap_angle(std::atan2(ray.y, ray.x) + heading)) + 4.0F;
    const auto column = static_cast<std::size_t>(x);
    far_hills[column] = 0.02F + 0.13F * hill(azimuth, 3.1F, land);
    near_hills[column] = 0.05F * hill(azimuth, 9.7F, land + 1U) - 0.004F;
  }
  const auto drift = static_cast<float>(shot.time * 0.012);
  const Color haze = mix(light.sky_low, light.fog, 0.5F);
  const Color hill_light = light.ambient + light.sun * 0.35F;
  const Color wood = mix(light.leaf, Color{0.8F, 0.82F, 0.86F}, 0.6F * light.snow) * hill_light;
  const float veil = clamp01(light.fog_density * 75.0F);
  std::size_t i = 0;
  for (int y = 0; y < g.height; ++y) {
    const float r = row_of(y);
    for (int x = 0; x < g.width; ++x, ++i) {
      if (g.surface[i] != GBuffer::kNothing) continue;
      const float c = (static_cast<float>(x) + 0.5F - static_cast<float>(camera.cx)) * k;
      const float dx = fwd(camera.forward.x) + fwd(camera.right.x) * c + fwd(camera.down.x) * r;
      const float dy = fwd(camera.forward.y) + fwd(camera.right.y) * c + fwd(camera.down.y) * r;
      const float dz = fwd(camera.forward.z) + fwd(camera.right.z) * c + fwd(camera.down.z) * r;
      const float flat = std::sqrt(dx * dx + dy * dy);
      const float slope = dz / flat;
      const auto column = static_cast<std::size_t>(x);
      if (slope < near_hills[column]) {
        const Color field = mix(light.grass, Color{0.78F, 0.8F, 0.84F}, light.snow) * hill_light;
        picture[i] = mix(slope < 0.0F ? field : wood * 0.8F, haze, 0.25F + 0.75F * veil);
        continue;
      }
      if (slope < far_hills[column]) {
        picture[i] = mix(wood, haze, 0.6F + 0.4F * veil);
        continue;
      }
      const float up = clamp01(slope * 1.25F);
      Color sky = mix(light.sky_low, light.sky_high, up * (1.6F - 0.6F * up) * 0.9F);
      const float reach = 1.0F / (std::max(slope, 0.0F) + 0.12F) / flat;
      // Clouds keep their place over the land while the camera turns below them.
      const auto ch = static_cast<float>(std::cos(heading));
      const auto sh = static_cast<float>(std::sin(heading));
      const float wx = (dx * ch - dy * sh) * reach + drift;
      const float wy = (dx * sh + dy * ch) * reach;
      const float mass = 0.55F * noise(wx * 0.9F, wy * 0.9F, air) +
                         0.30F * noise(wx * 2.3F, wy * 2.3F, air + 1U) +
                         0.15F * noise(wx * 5.9F, wy * 5.9F, air + 2U);
      const float edge = 0.82F - 0.62F * light.cloud_cover;
      const float cover = smooth(edge - 0.06F, edge + 0.2F, mass) * smooth(0.0F, 0.12F, slope);
      sky = mix(sky, light.cloud * (0.72F + 0.45F * (1.0F - mass)), 0.9F * cover);
      picture[i] = mix(sky, light.fog, veil * (1.0F - 0.6F * up));
    }
  }
}

}  // namespace seqloop::street
