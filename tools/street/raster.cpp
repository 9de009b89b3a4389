// SPDX-License-Identifier: MIT
#include "raster.hpp"

#include <cmath>

namespace seqloop::street {

GBuffer::GBuffer(int w, int h) : width(w), height(h) {
  const auto n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  near.resize(n);
  u.resize(n);
  v.resize(n);
  surface.resize(n);
  sun.resize(n);
  open.resize(n);
}

void GBuffer::clear() {
  std::fill(near.begin(), near.end(), 0.0F);
  std::fill(surface.begin(), surface.end(), kNothing);
  std::fill(sun.begin(), sun.end(), 1.0F);
  std::fill(open.begin(), open.end(), 1.0F);
}

Polygon::Polygon(const Surface& s, const Camera& camera) : camera_(camera) {
  constexpr double kNear = 0.25;
  for (int i = 0; i < s.corner_count; ++i) {
    const Vec3 a = s.corners[i];
    const Vec3 b = s.corners[(i + 1) % s.corner_count];
    const auto put = [&](Vec3 p) {
      points_[count_++] = {camera.cx + camera.focal * p.x / p.z,
                           camera.cy + camera.focal * p.y / p.z};
    };
    if (a.z >= kNear) put(a);
    if ((a.z >= kNear) != (b.z >= kNear)) put(a + (b - a) * ((kNear - a.z) / (b.z - a.z)));
    if (count_ >= Surface::kMaxCorners + 1) break;
  }
  if (count_ < 3) return;
  double top = points_[0].y, bottom = points_[0].y, left = points_[0].x, right = points_[0].x;
  for (int i = 1; i < count_; ++i) {
    top = std::min(top, points_[i].y);
    bottom = std::max(bottom, points_[i].y);
    left = std::min(left, points_[i].x);
    right = std::max(right, points_[i].x);
  }
  if (right <= 0.0 || left >= camera.width || bottom <= 0.0 || top >= camera.height) return;
  y0_ = static_cast<int>(std::ceil(std::max(top, 0.0) - 0.5));
  y1_ = static_cast<int>(std::ceil(std::min(bottom, 1.0 * camera.height) - 0.5));
  // A pixel's ray r meets origin + u along_u + v along_v where these triple products say.
  const Vec3 normal = cross(s.along_u, s.along_v);
  const double reach = dot(s.origin, normal);
  if (std::fabs(reach) < 1e-9) {
    count_ = 0;
    return;
  }
  near_ = form(normal * (1.0 / reach));
  u_ = form(cross(s.along_v, s.origin) * (1.0 / reach));
  v_ = form(cross(s.origin, s.along_u) * (1.0 / reach));
}

Polygon::Form Polygon::form(Vec3 n) const noexcept {
  const double k = 1.0 / camera_.focal;
  return {n.x * k, n.y * k, n.z + (0.5 - camera_.cx) * k * n.x + (0.5 - camera_.cy) * k * n.y};
}

bool Polygon::span_at(int y, Span& span) const noexcept {
  const double line = y + 0.5;
  double left = 1e30;
  double right = -1e30;
  for (int i = 0; i < count_; ++i) {
    const Point a = points_[i];
    const Point b = points_[i + 1 == count_ ? 0 : i + 1];
    if ((a.y <= line) == (b.y <= line)) continue;
    const double x = a.x + (b.x - a.x) * ((line - a.y) / (b.y - a.y));
    left = std::min(left, x);
    right = std::max(right, x);
  }
  left = std::clamp(left, 0.0, 1.0 * camera_.width);
  right = std::clamp(right, 0.0, 1.0 * camera_.width);
  span.y = y;
  span.x0 = static_cast<int>(std::ceil(left - 0.5));
  span.x1 = static_cast<int>(std::ceil(right - 0.5));
  if (span.x0 >= span.x1) return false;
  const auto at = [&](const Form& f) { return f.x * span.x0 + f.y * y + f.c; };
  span.near = at(near_);
  span.near_step = near_.x;
  span.u = at(u_);
  span.u_step = u_.x;
  span.v = at(v_);
  span.v_step = v_.x;
  return true;
}

void draw(const Surface& surface, std::uint16_t index, const Camera& camera, GBuffer& g) {
  const Polygon polygon(surface, camera);
  if (!polygon.visible()) return;
  polygon.for_each_span([&](const Span& s) {
    const std::size_t row = static_cast<std::size_t>(s.y) * static_cast<std::size_t>(g.width);
    for (int x = s.x0; x < s.x1; ++x) {
      const double k = x - s.x0;
      const auto near = static_cast<float>(s.near + s.near_step * k);
      const std::size_t i = row + static_cast<std::size_t>(x);
      if (near <= g.near[i]) continue;
      g.near[i] = near;
      g.surface[i] = index;
      const float depth = 1.0F / near;
      g.u[i] = static_cast<float>(s.u + s.u_step * k) * depth;
      g.v[i] = static_cast<float>(s.v + s.v_step * k) * depth;
    }
  });
}

}  // namespace seqloop::street
