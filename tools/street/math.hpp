// SPDX-License-Identifier: MIT
// Small vectors, colours and the soft steps of which textures are made.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hash.hpp"

namespace seqloop::street {

constexpr double kPi = 3.14159265358979323846;

/// Point or direction, metres. In the layout frame x is ahead, y left, z up.
struct Vec3 {
  double x{}, y{}, z{};
};
constexpr Vec3 operator+(Vec3 a, Vec3 b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator*(Vec3 a, double k) noexcept { return {a.x * k, a.y * k, a.z * k}; }
constexpr double dot(Vec3 a, Vec3 b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) noexcept { return std::sqrt(dot(a, a)); }

/// Linear light, 0 = black, 1 = white paper in full light; lamps may exceed 1.
struct Color {
  float r{}, g{}, b{};
};
constexpr Color operator+(Color a, Color b) noexcept { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
constexpr Color operator*(Color a, Color b) noexcept { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
constexpr Color operator*(Color a, float k) noexcept { return {a.r * k, a.g * k, a.b * k}; }
/// @param t 0 gives a, 1 gives b.
constexpr Color mix(Color a, Color b, float t) noexcept {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}
constexpr float mix(float a, float b, float t) noexcept { return a + (b - a) * t; }

constexpr float clamp01(float x) noexcept { return x < 0.0F ? 0.0F : (x > 1.0F ? 1.0F : x); }
/// @return 0 below a, 1 above b, smooth between.
constexpr float smooth(float a, float b, float x) noexcept {
  const float t = clamp01((x - a) / (b - a));
  return t * t * (3.0F - 2.0F * t);
}
/// Share of a pixel of width `blur` at x that lies in [a, b]: edges without jaggies.
constexpr float inside(float x, float a, float b, float blur) noexcept {
  const float k = 1.0F / blur;
  return clamp01((x - a) * k + 0.5F) - clamp01((x - b) * k + 0.5F);
}
/// floor() to int, much quicker than the library's.
constexpr std::int32_t floor_int(float x) noexcept {
  const auto i = static_cast<std::int32_t>(x);
  return static_cast<float>(i) > x ? i - 1 : i;
}

/// Value noise on the unit lattice. @return smooth in x and y, 0..1, mean 0.5.
constexpr float noise(float x, float y, std::uint32_t seed) noexcept {
  const std::int32_t i = floor_int(x);
  const std::int32_t j = floor_int(y);
  float a = x - static_cast<float>(i);
  float b = y - static_cast<float>(j);
  a = a * a * (3.0F - 2.0F * a);
  b = b * b * (3.0F - 2.0F * b);
  const float low = mix(lattice_unit(i, j, seed), lattice_unit(i + 1, j, seed), a);
  const float high = mix(lattice_unit(i, j + 1, seed), lattice_unit(i + 1, j + 1, seed), a);
  return mix(low, high, b);
}

}  // namespace seqloop::street
