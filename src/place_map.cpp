#include "seqloop/place_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

const Capacity& checked(const Capacity& capacity) {
  Faults faults = validate(capacity);
  if (!faults.empty()) throw SetupError(std::move(faults));
  return capacity;
}

}  // namespace

std::vector<BufferSize> PlaceMap::plan(const Capacity& capacity) {
  std::vector<BufferSize> buffers;
  PlaceMap measured(Arena(buffers), checked(capacity), ArenaMemory());
  return buffers;
}

PlaceMap::PlaceMap(const Capacity& capacity, std::span<std::byte> memory)
    : PlaceMap(capacity, ArenaMemory(bytes_needed(capacity), memory)) {}

PlaceMap::PlaceMap(const Capacity& capacity, ArenaMemory&& memory)
    : PlaceMap(Arena(memory.span()), capacity, std::move(memory)) {}

PlaceMap::PlaceMap(Arena arena, const Capacity& capacity, ArenaMemory&& memory)
    : memory_(std::move(memory)),
      capacity_(capacity),
      stride_(padded_size(capacity.descriptor_size)),
      statistics_(arena, capacity.descriptor_size),
      places_(arena.take<float>("places", capacity.places * stride_)) {}

bool PlaceMap::add(std::span<const float> descriptor) noexcept {
  if (size_ == capacity_.places || descriptor.size() != capacity_.descriptor_size) return false;
  if (statistics_.frames() != 0) return false;
  if (!std::ranges::all_of(descriptor, [](float value) { return std::isfinite(value); })) {
    return false;
  }
  std::ranges::copy(descriptor, places_.subspan(size_ * stride_, stride_).begin());
  ++size_;
  return true;
}

void PlaceMap::standardise() noexcept {
  if (statistics_.frames() != 0) return;
  for (std::size_t row = 0; row < size_; ++row) {
    statistics_.observe(place(row).first(capacity_.descriptor_size));
  }
  for (std::size_t row = 0; row < size_; ++row) {
    const std::span<float> place = places_.subspan(row * stride_, capacity_.descriptor_size);
    statistics_.standardise(place, place);
  }
}

}  // namespace seqloop
