// SPDX-License-Identifier: MIT
#include "program/bench/matrix_bench.hpp"

#include <algorithm>
#include <utility>

#include "program/process/available_memory.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "synthetic/places.hpp"

namespace seqloop::program {
namespace {

constexpr std::size_t frames_at_once = MatcherConfig::most_frames_at_once;

MatcherConfig config_of(std::size_t ds) {
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.sequence_length = ds;
  config.frames_at_once = frames_at_once;
  return config;
}

/// A synthetic drive, kept.
class Drive {
 public:
  Drive(const Capacity& size, float noise)
      : size_(size.descriptor_size),
        stride_(padded_size(size_)),
        values_(size.places * stride_, 0.0F) {
    SyntheticPlaces street(size_);
    for (std::size_t i = 0; i < size.places; ++i) {
      street.see(static_cast<double>(i), noise, std::span(values_).subspan(i * stride_, size_));
    }
  }
  [[nodiscard]] std::span<const float> values() const { return values_; }
  [[nodiscard]] std::span<const float> frame(std::size_t i) const {
    return values().subspan(i * stride_, size_);
  }
  [[nodiscard]] std::size_t frames() const { return values_.size() / stride_; }

 private:
  std::size_t size_;
  std::size_t stride_;
  std::vector<float> values_;
};

PlaceMap map_of(const Drive& drive, const MatcherConfig& config, const Capacity& size) {
  PlaceMap map(config, size);
  for (std::size_t i = 0; i < drive.frames(); ++i) (void)map.learn(drive.frame(i));
  for (std::size_t i = 0; i < drive.frames(); ++i) (void)map.add(drive.frame(i));
  return map;
}

void match_all(Detector& detector, const Drive& drive) {
  std::vector<std::span<const float>> frames(frames_at_once);
  std::vector<FrameReport> reports(frames_at_once);
  for (std::size_t first = 0; first < drive.frames(); first += frames_at_once) {
    const std::size_t count = std::min(frames_at_once, drive.frames() - first);
    for (std::size_t i = 0; i < count; ++i) frames[i] = drive.frame(first + i);
    static_cast<void>(detector.steps(std::span(frames).first(count), reports));
  }
}

}  // namespace

void time_matrix(const Capacity& size, std::size_t ds, const PeerMatrices& peers,
                 std::size_t rounds, std::vector<Contender>& timed) {
  const MatcherConfig config = config_of(ds);
  const std::uint64_t drive_bytes =
      std::uint64_t{size.places} * padded_size(size.descriptor_size) * sizeof(float);
  const std::uint64_t bytes = PlaceMap::bytes_needed(config, size) +
                              Detector::bytes_needed(config, size) + 2 * drive_bytes +
                              std::uint64_t{size.places} * size.places * sizeof(float);
  if (!fits_memory(bytes, "matrix")) return;
  const Drive reference(size, 0.0F);
  const Drive query(size, 1.0F);
  PlaceMap map = map_of(reference, config, size);
  Detector detector(config, map);
  const std::size_t goes = (size.places + frames_at_once - 1) / frames_at_once;
  std::vector<Contender> contenders;
  contenders.push_back({"matrix", "seqloop-int8-with-matches", size.places, size.descriptor_size,
                        goes * size.places * padded_bytes(size.descriptor_size),
                        [&] { match_all(detector, query); }});
  if (peers) {
    for (Contender& peer : peers({size, query.values(), reference.values()})) {
      contenders.push_back(std::move(peer));
    }
  }
  time_in_turn(std::move(contenders), rounds, timed, {1, 1});
}

}  // namespace seqloop::program
