#include "seqloop/difference_slices.hpp"

#include <algorithm>

#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

constexpr float not_computed = -1.0F;

}  // namespace

DifferenceSlices::DifferenceSlices(Arena& arena, std::size_t columns, std::size_t history,
                                   const Capacity& capacity)
    : columns_(columns),
      history_(history),
      places_(capacity.places),
      stride_(padded_size(capacity.descriptor_size)),
      queries_(arena.take<float>("query descriptors", history * stride_)),
      differences_(arena.take<float>("difference slices", columns * places_)),
      filled_to_(arena.take<std::size_t>("filled parts of the slices", columns)) {}

std::span<float> DifferenceSlices::push() noexcept {
  const std::uint64_t frame = frames_++;
  const auto slot = static_cast<std::size_t>(frame % columns_);
  std::ranges::fill(differences_.subspan(slot * places_, places_), not_computed);
  filled_to_[slot] = 0;
  return queries_.subspan(static_cast<std::size_t>(frame % history_) * stride_, stride_);
}

std::size_t DifferenceSlices::fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                                   std::size_t last) noexcept {
  const auto slot = static_cast<std::size_t>(frame % columns_);
  const std::span<const float> query_descriptor = query(frame);
  const std::span<float> differences = differences_.subspan(slot * places_, places_);
  std::size_t& filled_to = filled_to_[slot];
  std::size_t computed = 0;
  for (std::size_t row = std::max(first, filled_to); row < last; ++row) {
    if (differences[row] != not_computed) continue;
    differences[row] = euclidean(query_descriptor, map.place(row));
    ++computed;
  }
  if (first <= filled_to) filled_to = std::max(filled_to, last);
  return computed;
}

}  // namespace seqloop
