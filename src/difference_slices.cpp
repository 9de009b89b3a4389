#include "seqloop/difference_slices.hpp"

#include <algorithm>

#include "seqloop/difference.hpp"

namespace seqloop {

DifferenceSlices::DifferenceSlices(Arena& arena, const MatcherConfig& config, std::size_t history,
                                   const Capacity& capacity)
    : kind_(config.difference),
      enhance_(config.enhance),
      contrast_(config.rwindow),
      history_(history),
      stride_(padded_size(capacity.descriptor_size)),
      descriptor_size_(capacity.descriptor_size),
      queries_(arena.take<float>("query descriptors", history * stride_)),
      differences_(arena, "difference slices", "filled parts of the slices",
                   config.sequence_length + 1, capacity.places),
      enhanced_(arena, "enhanced slices", "filled parts of the enhanced slices",
                enhance_ ? config.sequence_length + 1 : 0, capacity.places) {}

std::span<float> DifferenceSlices::push() noexcept {
  const std::uint64_t frame = frames_++;
  differences_.begin(frame);
  if (enhance_) enhanced_.begin(frame);
  return descriptor(frame);
}

void DifferenceSlices::repeat() noexcept {
  const std::uint64_t frame = frames_++;
  std::ranges::copy(query(frame - 1), descriptor(frame).begin());
  differences_.repeat(frame);
  if (enhance_) enhanced_.repeat(frame);
}

float DifferenceSlices::between(std::uint64_t a, std::uint64_t b) const noexcept {
  return difference(kind_, query(a), query(b), descriptor_size_);
}

std::size_t DifferenceSlices::fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                                   std::size_t last) noexcept {
  if (first >= last) return 0;
  const std::size_t reach = enhance_ ? contrast_.reach() : 0;
  const std::size_t from = first - std::min(first, reach);
  const std::size_t to = std::min(last + reach, map.size());
  const std::size_t computed = differences_.fill(frame, from, to, [&](std::size_t row) {
    return difference(kind_, query(frame), map.place(row), descriptor_size_);
  });
  if (enhance_) {
    const std::span<const float> column = differences_.column(frame);
    enhanced_.fill(frame, first, last,
                   [&](std::size_t row) { return contrast_.enhance(column, row, map.size()); });
  }
  return computed;
}

}  // namespace seqloop
