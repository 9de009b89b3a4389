// SPDX-License-Identifier: MIT
#include "program/bench/matrix_bench.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "program/process/available_memory.hpp"
#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/linux/touched_memory.hpp"
#include "synthetic/places.hpp"

namespace seqloop::program {
namespace {

constexpr std::size_t frames_at_once = MatcherConfig::most_frames_at_once;

MatcherConfig matrix_config(std::size_t ds, Arithmetic arithmetic) {
  MatcherConfig config;
  config.arithmetic = arithmetic;
  config.candidates = Candidates::all;
  config.sequence_length = ds;
  config.frames_at_once = frames_at_once;
  return config;
}

/// A synthetic drive, kept where a map would keep it: its vectors begin on cache lines.
class Drive {
 public:
  Drive(const Capacity& size, float noise)
      : size_(size.descriptor_size),
        stride_(padded_size(size_)),
        memory_(std::uint64_t{size.places} * stride_ * sizeof(float) + Arena::alignment),
        values_(Arena(memory_.span()).take<float>("drive", size.places * stride_)) {
    SyntheticPlaces street(size_);
    for (std::size_t i = 0; i < size.places; ++i) {
      street.see(static_cast<double>(i), noise, values_.subspan(i * stride_, size_));
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
  live::TouchedMemory memory_;
  std::span<float> values_;
};

/// A map and who matches with it.
struct Matched {
  Matched(const Drive& reference, const MatcherConfig& config, const Capacity& size)
      : memory(PlaceMap::bytes_needed(config, size)),
        map(filled(PlaceMap(config, size, memory.span(), true), reference)),
        working_memory(Detector::bytes_needed(config, size)),
        detector(config, map, working_memory.span()) {}

  [[nodiscard]] static std::uint64_t bytes_needed(const MatcherConfig& config,
                                                  const Capacity& size) {
    return PlaceMap::bytes_needed(config, size) + Detector::bytes_needed(config, size);
  }

  [[nodiscard]] static PlaceMap filled(PlaceMap map, const Drive& drive) {
    for (std::size_t i = 0; i < drive.frames(); ++i) (void)map.add(drive.frame(i));
    return map;
  }

  live::TouchedMemory memory;
  PlaceMap map;
  live::TouchedMemory working_memory;
  Detector detector;
};

/// All dot products of floats: what a product of matrices is compared with.
void compare_all(const Drive& query, const Drive& reference) {
  constexpr std::size_t abreast = DescriptorRows::block_rows;
  const FloatKernels& kernels = best_float_kernels();
  const std::size_t stride = query.values().size() / query.frames();
  std::vector<double> dots(frames_at_once * abreast);
  for (std::size_t first = 0; first < query.frames(); first += frames_at_once) {
    const std::size_t count = std::min(frames_at_once, query.frames() - first);
    for (std::size_t row = 0; row < reference.frames(); row += abreast) {
      kernels.dots_block(query.frame(first).data(), count, reference.frame(row).data(), stride,
                         std::min(abreast, reference.frames() - row), dots.data(), abreast);
    }
  }
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
  const MatcherConfig small = matrix_config(ds, Arithmetic::int8);
  const MatcherConfig exact = matrix_config(ds, Arithmetic::float32);
  const std::uint64_t drive_bytes =
      std::uint64_t{size.places} * padded_size(size.descriptor_size) * sizeof(float);
  const std::uint64_t bytes = Matched::bytes_needed(small, size) +
                              Matched::bytes_needed(exact, size) + 2 * drive_bytes +
                              std::uint64_t{size.places} * size.places * sizeof(float);
  if (!fits_memory(bytes, "matrix")) return;
  const Drive reference(size, 0.0F);
  const Drive query(size, 1.0F);
  Matched by_int8(reference, small, size);
  Matched by_float(reference, exact, size);
  const std::size_t goes = (size.places + frames_at_once - 1) / frames_at_once;
  std::vector<Contender> contenders;
  const auto add = [&](const char* by, std::uint64_t bytes_read, std::function<void()> round) {
    contenders.push_back(
        {"matrix", by, size.places, size.descriptor_size, bytes_read, std::move(round)});
  };
  add("seqloop-int8-with-matches", goes * size.places * padded_bytes(size.descriptor_size),
      [&] { match_all(by_int8.detector, query); });
  add("seqloop-float-with-matches", goes * drive_bytes,
      [&] { match_all(by_float.detector, query); });
  add("seqloop-float", goes * drive_bytes, [&] { compare_all(query, reference); });
  if (peers) {
    for (Contender& peer : peers({size, query.values(), reference.values()})) {
      contenders.push_back(std::move(peer));
    }
  }
  time_in_turn(std::move(contenders), rounds, timed, {1, 1});
}

}  // namespace seqloop::program
