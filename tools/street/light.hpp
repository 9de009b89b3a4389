// SPDX-License-Identifier: MIT
// Conditions: sun, sky, season, fog, lamps and the camera's exposure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "math.hpp"

namespace seqloop::street {

/// All that differs between two drives down the same street except where the camera is.
struct Light {
  Color sun{2.2F, 2.05F, 1.75F};        ///< light of the bare sun on a surface that faces it
  float sun_azimuth = 0.8F;             ///< rad, absolute, counter-clockwise
  float sun_elevation = 0.9F;           ///< rad, 0.1..1.5
  Color ambient{0.55F, 0.62F, 0.75F};   ///< light in the shade
  Color sky_high{0.16F, 0.34F, 0.80F};  ///< straight up
  Color sky_low{0.62F, 0.76F, 0.92F};   ///< at the horizon
  Color cloud{1.05F, 1.05F, 1.05F};
  float cloud_cover = 0.4F;  ///< 0..1
  Color fog{0.66F, 0.76F, 0.88F};
  float fog_density = 0.0015F;  ///< 1/m
  float snow = 0.0F;            ///< 0..1, on ground, roofs and ledges
  float leaves = 1.0F;          ///< 0 bare .. 1 full
  Color leaf{0.10F, 0.20F, 0.04F};
  Color grass{0.15F, 0.27F, 0.07F};
  float wet = 0.0F;           ///< 0..1, darker ground
  float lamps = 0.0F;         ///< 0..1, brightness of lamps, windows and signs
  float lit_windows = 0.05F;  ///< share of windows with a light behind them
  float exposure = 1.0F;
  Color cast{1.0F, 1.0F, 1.0F};  ///< white balance error
  float sensor_noise = 2.0F;     ///< standard deviation, 8-bit grey levels
  float vignette = 0.25F;        ///< darkening in the corners, 0..1
};

/// @param name summer, autumn, evening or winter. @return nothing if there is no such light.
std::optional<Light> light_named(std::string_view name);

/// @return the names light_named() takes, separated by '|'.
std::string light_names();

/// @param t 0 gives a, 1 gives b, each quantity linear between.
Light mix(const Light& a, const Light& b, float t);

}  // namespace seqloop::street
