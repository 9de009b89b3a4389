// SPDX-License-Identifier: MIT
#include <cmath>

#include "sprites.hpp"

namespace seqloop::street {

void Picture::put(int x, int y, float cover, Texel t) {
  if (x < 0 || y < 0 || x >= kSize || y >= kSize || cover <= 0.0F) return;
  const std::size_t i = static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x);
  Texel& old = levels_[0][i];
  const float a = cover * t.alpha;
  const float sum = a + old.alpha * (1.0F - a);
  if (sum <= 0.0F) return;
  const float share = a / sum;
  old = {sum, mix(old.tone, t.tone, share), mix(old.leaf, t.leaf, share),
         mix(old.glow, t.glow, share)};
}

void Picture::disc(double x, double y, double radius, Texel t) {
  const double cx = x * kSize - 0.5;
  const double cy = (1.0 - y) * kSize - 0.5;
  const double r = radius * kSize;
  const int reach = static_cast<int>(r) + 2;
  for (int j = static_cast<int>(cy) - reach; j <= static_cast<int>(cy) + reach; ++j) {
    for (int i = static_cast<int>(cx) - reach; i <= static_cast<int>(cx) + reach; ++i) {
      const double far = std::hypot(i - cx, j - cy);
      put(i, j, clamp01(static_cast<float>(r - far + 0.5)), t);
    }
  }
}

void Picture::line(double x0, double y0, double x1, double y1, double wide0, double wide1,
                   Texel t) {
  const double ax = x0 * kSize - 0.5, ay = (1.0 - y0) * kSize - 0.5;
  const double bx = x1 * kSize - 0.5, by = (1.0 - y1) * kSize - 0.5;
  const double dx = bx - ax, dy = by - ay;
  const double size = dx * dx + dy * dy + 1e-9;
  const double reach = 0.5 * std::max(wide0, wide1) * kSize + 1.0;
  const int left = static_cast<int>(std::floor(std::min(ax, bx) - reach));
  const int right = static_cast<int>(std::ceil(std::max(ax, bx) + reach));
  const int top = static_cast<int>(std::floor(std::min(ay, by) - reach));
  const int bottom = static_cast<int>(std::ceil(std::max(ay, by) + reach));
  for (int j = top; j <= bottom; ++j) {
    for (int i = left; i <= right; ++i) {
      const double k = std::clamp(((i - ax) * dx + (j - ay) * dy) / size, 0.0, 1.0);
      const double far = std::hypot(i - ax - dx * k, j - ay - dy * k);
      const double half = 0.5 * (wide0 + (wide1 - wide0) * k) * kSize;
      put(i, j, clamp01(static_cast<float>(std::min(half - far + 0.5, 2.0 * half))), t);
    }
  }
}

void Picture::box(double x0, double y0, double x1, double y1, Texel t) {
  const int left = static_cast<int>(std::lround(x0 * kSize));
  const int right = static_cast<int>(std::lround(x1 * kSize));
  const int top = static_cast<int>(std::lround((1.0 - y1) * kSize));
  const int bottom = static_cast<int>(std::lround((1.0 - y0) * kSize));
  for (int j = top; j < bottom; ++j) {
    for (int i = left; i < right; ++i) put(i, j, 1.0F, t);
  }
}

void Picture::finish() {
  for (int size = kSize / 2; size >= 4; size /= 2) {
    const std::vector<Texel>& big = levels_.back();
    std::vector<Texel> small(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) {
        Texel sum;
        for (const int k : {0, 1, 2 * size, 2 * size + 1}) {
          const Texel& t = big[static_cast<std::size_t>(4 * j * size + 2 * i + k)];
          sum.alpha += t.alpha;
          sum.tone += t.alpha * t.tone;
          sum.leaf += t.alpha * t.leaf;
          sum.glow += t.alpha * t.glow;
        }
        const float k = sum.alpha > 0.0F ? 1.0F / sum.alpha : 0.0F;
        small[static_cast<std::size_t>(j * size + i)] = {0.25F * sum.alpha, sum.tone * k,
                                                         sum.leaf * k, sum.glow * k};
      }
    }
    levels_.push_back(std::move(small));
  }
}

int Picture::level_for(float pixels) noexcept {
  int level = 0;
  for (float size = kSize; size > 1.5F * pixels && level < 5; size *= 0.5F) ++level;
  return level;
}

Texel Picture::at(float x, float y, int level) const noexcept {
  const int size = kSize >> level;
  const std::vector<Texel>& texels = levels_[static_cast<std::size_t>(level)];
  const float fx =
      std::clamp(x * static_cast<float>(size) - 0.5F, 0.0F, static_cast<float>(size) - 1.001F);
  const float fy =
      std::clamp(y * static_cast<float>(size) - 0.5F, 0.0F, static_cast<float>(size) - 1.001F);
  const int i = static_cast<int>(fx);
  const int j = static_cast<int>(fy);
  const float a = fx - static_cast<float>(i);
  const float b = fy - static_cast<float>(j);
  Texel sum;
  const auto add = [&](int k, int l, float weight) {
    const Texel& t = texels[static_cast<std::size_t>(l * size + k)];
    const float w = weight * t.alpha;
    sum.alpha += w;
    sum.tone += w * t.tone;
    sum.leaf += w * t.leaf;
    sum.glow += w * t.glow;
  };
  add(i, j, (1.0F - a) * (1.0F - b));
  add(i + 1, j, a * (1.0F - b));
  add(i, j + 1, (1.0F - a) * b);
  add(i + 1, j + 1, a * b);
  if (sum.alpha > 0.0F) {
    const float k = 1.0F / sum.alpha;
    sum.tone *= k;
    sum.leaf *= k;
    sum.glow *= k;
  }
  return sum;
}

}  // namespace seqloop::street
