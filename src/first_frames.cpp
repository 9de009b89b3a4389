// SPDX-License-Identifier: MIT
#include "seqloop/detail/first_frames.hpp"

#include <algorithm>
#include <optional>

#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

// Moving frames that a trace may stay on the first row of a session for. A robot that would have to
// stay longer has come onto the map from before it.
constexpr std::size_t most_stays = 2;

}  // namespace

FirstFrames::FirstFrames(Arena& arena, bool used)
    : scenes_(arena.take<Scene>("scenes of the first frames", used ? most : 0)),
      sketches_(
          arena.take<std::uint64_t>("sketches of the first frames", used ? most * words : 0)) {}

void FirstFrames::take(const SceneView& view, const Scene& scene) noexcept {
  if (count_ == most || view.newest != view.oldest + count_) return;
  first_ = view.oldest;
  rows_ = view.rows;
  const QueryHistory& queries = *view.queries;
  std::ranges::copy(queries.moved().close_sketch(queries.row_of(view.newest)),
                    sketches_.subspan(count_ * words).begin());
  scenes_[count_++] = scene;
}

void FirstFrames::repeat(std::uint64_t frames) noexcept {
  for (; frames > 0 && count_ > 0 && count_ < most; --frames, ++count_) {
    std::ranges::copy(sketch(count_ - 1), sketches_.subspan(count_ * words).begin());
    scenes_[count_] = scenes_[count_ - 1];
    scenes_[count_].novelty = scenes_[count_].change = 0.0;
  }
}

std::size_t FirstFrames::follow(const PlaceMap& map, std::span<BeliefTraces::Step> trace,
                                std::size_t count, std::uint64_t newest,
                                std::size_t& sketches) const noexcept {
  const std::uint64_t began = newest - (count - 1);
  if (count_ == 0 || began <= first_ || began > first_ + count_) return count;
  auto frame = static_cast<std::size_t>(began - first_);
  std::size_t row = trace[count - 1].row;
  const CandidateRun session = map.order().around(row);
  std::size_t at = count;
  std::size_t stays = 0;
  while (frame-- > 0 && at < trace.size()) {
    const Scene& scene = scenes_[frame];
    const bool stays_at_first = row == session.first && scene.drives();
    if (stays_at_first && ++stays > most_stays) return count;
    FramePair frames{sketch(frame), std::nullopt};
    if (frame >= frames_apart) frames.before = sketch(frame - frames_apart);
    double best = 0.0;
    std::size_t from = row;
    for (std::size_t by = 0; by < scene.moves().size() && row >= session.first + by; ++by) {
      const double share = share_of_bits(map, frames.newest, row - by, sketches);
      const double likely = scene.moves()[by] * exponential(scene.likeness(share));
      if (likely <= best) continue;
      best = likely;
      from = row - by;
    }
    row = from;
    const double gain = gain_of(scene, map, rows_, frames, row, sketches).gain;
    trace[at++] = {row, scene.novelty * gain, scene.novelty, scene.change};
  }
  return at;
}

}  // namespace seqloop
