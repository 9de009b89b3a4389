// SPDX-License-Identifier: MIT
#include "light.hpp"

namespace seqloop::street {
namespace {

Light autumn() {
  Light l;
  l.sun = {0.25F, 0.23F, 0.20F};
  l.sun_azimuth = 2.4F;
  l.sun_elevation = 0.5F;
  l.ambient = {0.80F, 0.82F, 0.86F};
  l.sky_high = {0.50F, 0.55F, 0.62F};
  l.sky_low = {0.78F, 0.80F, 0.82F};
  l.cloud = {0.80F, 0.80F, 0.80F};
  l.cloud_cover = 0.95F;
  l.fog = {0.74F, 0.77F, 0.80F};
  l.fog_density = 0.005F;
  l.leaf = {0.36F, 0.18F, 0.03F};
  l.grass = {0.22F, 0.22F, 0.08F};
  l.wet = 0.7F;
  l.lamps = 0.25F;
  l.lit_windows = 0.15F;
  l.exposure = 0.95F;
  l.sensor_noise = 3.0F;
  return l;
}

Light evening() {
  Light l;
  l.sun = {1.5F, 0.72F, 0.28F};
  l.sun_azimuth = 3.3F;
  l.sun_elevation = 0.22F;
  l.ambient = {0.34F, 0.34F, 0.46F};
  l.sky_high = {0.12F, 0.17F, 0.40F};
  l.sky_low = {1.00F, 0.56F, 0.28F};
  l.cloud = {0.95F, 0.50F, 0.38F};
  l.cloud_cover = 0.55F;
  l.fog = {0.72F, 0.50F, 0.40F};
  l.fog_density = 0.003F;
  l.lamps = 0.7F;
  l.lit_windows = 0.35F;
  l.exposure = 1.15F;
  l.cast = {1.06F, 1.0F, 0.92F};
  l.sensor_noise = 4.0F;
  l.vignette = 0.3F;
  return l;
}

Light winter() {
  Light l;
  l.sun = {0.10F, 0.08F, 0.09F};
  l.sun_azimuth = 4.1F;
  l.sun_elevation = 0.15F;
  l.ambient = {0.17F, 0.20F, 0.30F};
  l.sky_high = {0.05F, 0.07F, 0.15F};
  l.sky_low = {0.22F, 0.22F, 0.31F};
  l.cloud = {0.20F, 0.19F, 0.24F};
  l.cloud_cover = 0.7F;
  l.fog = {0.20F, 0.21F, 0.28F};
  l.fog_density = 0.011F;
  l.snow = 1.0F;
  l.leaves = 0.0F;
  l.leaf = {0.10F, 0.08F, 0.07F};
  l.grass = {0.12F, 0.12F, 0.06F};
  l.lamps = 1.0F;
  l.lit_windows = 0.45F;
  l.exposure = 1.9F;
  l.cast = {0.92F, 0.98F, 1.12F};
  l.sensor_noise = 5.0F;
  l.vignette = 0.4F;
  return l;
}

}  // namespace

std::optional<Light> light_named(std::string_view name) {
  if (name == "summer") return Light{};
  if (name == "autumn") return autumn();
  if (name == "evening") return evening();
  if (name == "winter") return winter();
  return std::nullopt;
}

std::string light_names() { return "summer|autumn|evening|winter"; }

Light mix(const Light& a, const Light& b, float t) {
  Light m;
  m.sun = mix(a.sun, b.sun, t);
  m.sun_azimuth = mix(a.sun_azimuth, b.sun_azimuth, t);
  m.sun_elevation = mix(a.sun_elevation, b.sun_elevation, t);
  m.ambient = mix(a.ambient, b.ambient, t);
  m.sky_high = mix(a.sky_high, b.sky_high, t);
  m.sky_low = mix(a.sky_low, b.sky_low, t);
  m.cloud = mix(a.cloud, b.cloud, t);
  m.cloud_cover = mix(a.cloud_cover, b.cloud_cover, t);
  m.fog = mix(a.fog, b.fog, t);
  m.fog_density = mix(a.fog_density, b.fog_density, t);
  m.snow = mix(a.snow, b.snow, t);
  m.leaves = mix(a.leaves, b.leaves, t);
  m.leaf = mix(a.leaf, b.leaf, t);
  m.grass = mix(a.grass, b.grass, t);
  m.wet = mix(a.wet, b.wet, t);
  m.lamps = mix(a.lamps, b.lamps, t);
  m.lit_windows = mix(a.lit_windows, b.lit_windows, t);
  m.exposure = mix(a.exposure, b.exposure, t);
  m.cast = mix(a.cast, b.cast, t);
  m.sensor_noise = mix(a.sensor_noise, b.sensor_noise, t);
  m.vignette = mix(a.vignette, b.vignette, t);
  return m;
}

}  // namespace seqloop::street
