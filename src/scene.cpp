// SPDX-License-Identifier: MIT
#include "seqloop/detail/scene.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "seqloop/detail/portable_math.hpp"
#include "seqloop/detail/sketch.hpp"

namespace seqloop {
namespace {

constexpr double scanned_bits = DescriptorRows::scanned_words * 64.0;

/// As `Scene` has them.
struct News {
  double change;
  double novelty;
};

/// How much the newest frame tells that those before it did not: the first one all.
/// @param mean share of bits in which rows differ from it
News news_of(const SceneView& view, double mean, std::size_t& sketches) {
  constexpr double power = 0.7;
  constexpr double highest = 0.5;
  const auto weighed = [](double change, double gone) {
    const double weight = exponential(power * logarithm(change));
    return News{weight, weight * gone};
  };
  const std::uint64_t frames = view.newest - view.oldest;
  if (frames == 0) return weighed(highest, 1.0);
  const DescriptorRows& queries = view.queries->rows();
  const auto squared = [&](std::size_t back) {
    return squared_way(queries, view.queries->row_of(view.newest),
                       view.queries->row_of(view.newest - back), sketches);
  };
  const double before = squared(1);
  const double cosine = std::max(0.0, 1.0 - before / 2.0);
  constexpr double noise = 0.03;
  const double change = std::min(highest, std::max(0.0, 1.0 - cosine - noise) / (1.0 + cosine));
  if (change <= 0.0) return {0.0, 0.0};
  // A camera that shakes, or noise, changes much from frame to frame and goes nowhere.
  const double mu = squared_chord(mean);
  double gone = 1.0;
  if (before <= 0.9 * mu) {
    const double earlier =
        squared(static_cast<std::size_t>(std::min<std::uint64_t>(SceneGauge::reach, frames)));
    gone = std::clamp((earlier - before) / (0.5 * (mu - before)), 0.0, 1.0);
  }
  return weighed(change, gone);
}

}  // namespace

SceneGauge::SceneGauge(Arena& arena, bool used)
    : histogram_(arena.take<std::uint32_t>(
          "histogram of a scan", used ? static_cast<std::size_t>(scanned_bits) + 1 : 0)) {}

std::optional<Scene> SceneGauge::look(const SceneView& view, std::size_t& sketches) noexcept {
  const std::span<const std::uint32_t> bits = view.seen->scanned();
  if (view.rows < least_rows) return std::nullopt;
  std::ranges::fill(histogram_, 0U);
  for (const std::uint32_t b : bits) ++histogram_[b];
  const auto any = [](std::uint32_t count) { return count > 0; };
  const auto likest = static_cast<std::size_t>(
      std::distance(histogram_.begin(), std::ranges::find_if(histogram_, any)));
  std::size_t end = histogram_.size();
  while (!any(histogram_[end - 1])) --end;
  std::uint64_t sum = 0;
  std::uint64_t squares = 0;
  for (std::size_t b = likest; b < end; ++b) {
    const std::uint64_t pairs = histogram_[b];
    sum += b * pairs;
    squares += b * b * pairs;
  }
  const auto n = static_cast<double>(bits.size());
  const double mean = static_cast<double>(sum) / n / scanned_bits;
  const double variance =
      static_cast<double>(squares) / n / (scanned_bits * scanned_bits) - mean * mean;
  // Few bits make the shares noisier than more of them will be.
  const double chance = mean * (1.0 - mean);
  constexpr double least_deviation = 0.012;
  const double spread =
      std::max(variance - chance / scanned_bits, least_deviation * least_deviation);
  const double scanned = std::sqrt(spread + chance / scanned_bits);
  // The mean of e^z, which from one count of bits to the next falls by the same share.
  const double falls = exponential(-1.0 / (scanned_bits * scanned));
  double power = exponential((mean - static_cast<double>(likest) / scanned_bits) / scanned);
  double exponentials = 0.0;
  for (std::size_t b = likest; b < end; ++b) {
    exponentials += static_cast<double>(histogram_[b]) * power;
    power *= falls;
  }
  constexpr double above = 0.55;
  const News news = news_of(view, mean, sketches);
  return Scene{mean, std::sqrt(spread + chance / DescriptorRows::close_bits),
               logarithm(exponentials / n) + above, news.change, news.novelty};
}

double squared_way(const DescriptorRows& frames, std::size_t a, std::size_t b,
                   std::size_t& sketches) noexcept {
  ++sketches;
  return squared_chord(frames.look_closely(frames, a, b) / DescriptorRows::close_bits);
}

double share_of_bits(const PlaceMap& map, CloseSketch frame, std::size_t row,
                     std::size_t& sketches) noexcept {
  ++sketches;
  return map.rows().look_closely(frame, map.order().slot(row)) / DescriptorRows::close_bits;
}

RowGain gain_of(const Scene& scene, const PlaceMap& map, std::size_t rows, const FramePair& frames,
                std::size_t row, std::size_t& sketches) noexcept {
  const auto share = [&](CloseSketch frame, std::size_t there) {
    return share_of_bits(map, frame, there, sketches);
  };
  const double here = share(frames.newest, row);
  double before = 0.0;
  double contrast = 0.0;
  if (frames.before) {
    const CandidateRun session = map.order().around(row);
    before = share(*frames.before, row);
    double around = 2.0 * before;
    double weight = 2.0;
    if (row >= session.first + frames_apart) {
      around += share(frames.newest, row - frames_apart);
      weight += 1.0;
    }
    if (row + frames_apart < std::min(rows, session.last)) {
      around += share(frames.newest, row + frames_apart);
      weight += 1.0;
    }
    contrast = (around / weight - here) / scene.deviation;
  }
  const double gain = scene.likeness(here) + 0.7 * contrast - scene.bias;
  return {std::min(std::max(gain, -1.5), 3.0), gain, contrast, here, before};
}

double in_step(const Scene& scene, const PlaceMap& map, const FramePair& frames, const RowGain& at,
               std::size_t from, std::size_t& sketches) noexcept {
  const auto squared = [&](CloseSketch frame) {
    return squared_chord(share_of_bits(map, frame, from, sketches));
  };
  // What they are apart that have nothing to do with each other.
  const double apart = squared_chord(scene.mean);
  const double together = squared_chord(at.here) + squared(*frames.before);
  const double across = squared_chord(at.before) + squared(frames.newest);
  // Beyond that only where hardly any bits of any rows differ.
  constexpr double most = 4.0;
  const double along =
      std::clamp((across - together) / (2.0 * std::max(frames.way, 0.3 * apart)), -most, most);
  const double alike = std::max(0.0, 1.0 - together / (2.0 * apart));
  return along - 0.4 * alike - std::min(0.06, 0.25 * alike);
}

}  // namespace seqloop
