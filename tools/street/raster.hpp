// SPDX-License-Identifier: MIT
// Flat polygons to pixels, with depth; each pixel remembers what it shows for later shading.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "camera.hpp"

namespace seqloop::street {

/// What each pixel shows: the nearest surface and the place on it.
struct GBuffer {
  static constexpr std::uint16_t kNothing = 0xffff;

  int width{}, height{};
  std::vector<float> near;             ///< 1 / depth, 1/m; 0 is nothing
  std::vector<float> u, v;             ///< metres on the surface
  std::vector<std::uint16_t> surface;  ///< index, or kNothing
  std::vector<float> sun, open;        ///< share of sunlight and of skylight, 0..1

  GBuffer(int width, int height);
  void clear();
};

/// A row's pixels [x0, x1) of a polygon, and the linear forms on it: at pixel x, 1/z is
/// near + near_step * (x - x0), and the same for u/z and v/z.
struct Span {
  int y, x0, x1;
  double near, near_step;
  double u, u_step;
  double v, v_step;
};

/// A surface prepared for scan conversion.
class Polygon {
 public:
  /// Clips away what is nearer than 0.25 m.
  Polygon(const Surface& surface, const Camera& camera);

  /// @return false when no pixel can show it.
  bool visible() const noexcept { return count_ >= 3 && y0_ < y1_; }

  /// Calls fn(const Span&) for each row that shows some of it, from above to below.
  template <class Fn>
  void for_each_span(Fn&& fn) const {
    for (int y = y0_; y < y1_; ++y) {
      Span s{};
      if (span_at(y, s)) fn(s);
    }
  }

 private:
  struct Point {
    double x, y;
  };
  struct Form {
    double x, y, c;  ///< value at pixel (px, py) is x * px + y * py + c
  };
  bool span_at(int y, Span& span) const noexcept;
  Form form(Vec3 numerator) const noexcept;

  Camera camera_;
  Point points_[Surface::kMaxCorners + 2];
  int count_ = 0;
  int y0_ = 0, y1_ = 0;
  Form near_{}, u_{}, v_{};
};

/// Draws a surface wherever it is the nearest so far.
void draw(const Surface& surface, std::uint16_t index, const Camera& camera, GBuffer& g);

}  // namespace seqloop::street
