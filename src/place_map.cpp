// SPDX-License-Identifier: MIT
#include "seqloop/place_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace seqloop {
namespace {

// Rows among which the one that is missed least goes, each time a full map thins out.
constexpr std::size_t thinned_among = 64;

}  // namespace

std::vector<BufferSize> PlaceMap::plan(const MatcherConfig& config, const Capacity& capacity) {
  check(config, capacity);
  std::vector<BufferSize> buffers;
  const PlaceMap measured(Arena(buffers), config, capacity, ArenaMemory());
  return buffers;
}

PlaceMap::PlaceMap(const MatcherConfig& config, const Capacity& capacity,
                   std::span<std::byte> memory)
    : PlaceMap(config, capacity, ArenaMemory(bytes_needed(config, capacity), memory)) {}

PlaceMap::PlaceMap(const MatcherConfig& config, const Capacity& capacity, ArenaMemory&& memory)
    : PlaceMap(Arena(memory.span()), config, capacity, std::move(memory)) {}

PlaceMap::PlaceMap(Arena arena, const MatcherConfig& config, const Capacity& capacity,
                   ArenaMemory&& memory)
    : memory_(std::move(memory)),
      standardises_(config.standardisation.on && config.use == Use::localise),
      full_map_(config.full_map),
      statistics_(arena, capacity.descriptor_size),
      order_(arena, capacity.places),
      rows_(arena, {"places", "lengths of places", "sketches of places"},
            DescriptorForm(config, capacity.descriptor_size), capacity.places),
      standardised_(
          arena.take<float>("a standardised place", standardises_ ? capacity.descriptor_size : 0)),
      spacing_(arena.take<float>("spacing of places",
                                 full_map_ == FullMap::thin ? capacity.places : 0)) {}

bool PlaceMap::fits(std::span<const float> descriptor) const noexcept {
  return descriptor.size() == descriptor_size() &&
         std::ranges::all_of(descriptor, [](float value) { return std::isfinite(value); });
}

bool PlaceMap::learn(std::span<const float> descriptor) noexcept {
  if (!standardises_ || size() != 0 || !fits(descriptor)) return false;
  statistics_.observe(descriptor);
  return true;
}

bool PlaceMap::add(std::span<const float> descriptor) noexcept {
  if (size() == capacity() || !fits(descriptor)) return false;
  if (statistics_.frames() != 0) {
    statistics_.standardise(descriptor, standardised_);
    descriptor = standardised_;
  }
  rows_.store(order_.append(), descriptor);
  return true;
}

PlaceMap::Taken PlaceMap::take(const DescriptorRows& queries, std::size_t query,
                               std::size_t keep) noexcept {
  Taken taken;
  if (size() == capacity()) {
    taken.removed = row_to_go(keep);
    if (!taken.removed) return taken;
    order_.remove(*taken.removed);
    // The row behind the gap has another one before it now.
    const std::size_t behind = *taken.removed;
    if (full_map_ == FullMap::thin && behind > 0 && behind < size()) {
      spacing_[order_.slot(behind)] =
          static_cast<float>(rows_.between(order_.slot(behind), order_.slot(behind - 1)));
    }
  }
  const std::size_t slot = order_.append();
  rows_.copy(slot, queries, query);
  if (full_map_ == FullMap::thin && size() > 1) {
    spacing_[slot] = static_cast<float>(rows_.between(slot, order_.slot(size() - 2)));
  }
  taken.slot = slot;
  return taken;
}

std::optional<std::size_t> PlaceMap::row_to_go(std::size_t keep) noexcept {
  if (full_map_ == FullMap::refuse || size() <= keep) return std::nullopt;
  if (full_map_ == FullMap::forget_oldest) return 0;
  // The first and the last row of what may go have no two neighbours.
  const std::size_t last = size() - std::max<std::size_t>(keep, 1);
  if (hand_ + 1 >= last) hand_ = 0;
  const std::size_t end = std::min(hand_ + thinned_among, last - 1);
  std::size_t least = std::min(hand_ + 1, last - 1);
  const auto missed = [&](std::size_t row) {
    return spacing_[order_.slot(row)] + spacing_[order_.slot(row + 1)];
  };
  for (std::size_t row = least; row <= end; ++row) {
    if (missed(row) < missed(least)) least = row;
  }
  hand_ = end;
  return least;
}

}  // namespace seqloop
