#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "seqloop/arena.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/running_statistics.hpp"

namespace seqloop {

/// The places of a drive, in the order in which they were seen: R in the paper. Room for all of
/// them is taken at construction.
class PlaceMap {
 public:
  /// Bytes of every buffer. @param capacity as `validate` accepts it.
  [[nodiscard]] static std::vector<BufferSize> plan(const Capacity& capacity);
  [[nodiscard]] static std::size_t bytes_needed(const Capacity& capacity) {
    return total_bytes(plan(capacity));
  }

  /// @param memory [bytes_needed(capacity)] aligned to Arena::alignment; empty: own memory
  /// Errors: SetupError, all faults at once.
  explicit PlaceMap(const Capacity& capacity, std::span<std::byte> memory = {});

  /// Appends a place.
  /// @param descriptor [D]; without NaN or infinity
  /// @return false when the map is full or standardised already, or the descriptor is of another
  ///   size or not finite: then nothing has changed
  /// Work: D. Allocates: never.
  [[nodiscard]] bool add(std::span<const float> descriptor) noexcept;

  /// Takes the map's statistics and standardises every place by them, once all are there. Without
  /// this call places are compared as they came. A second call does nothing.
  /// Work: 5 N D. Allocates: never.
  void standardise() noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }  // N
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_.places; }
  [[nodiscard]] std::size_t descriptor_size() const noexcept { return capacity_.descriptor_size; }

  /// @param row 0 .. size()
  /// @return [padded_size(D)], zero beyond D
  [[nodiscard]] std::span<const float> place(std::size_t row) const noexcept {
    return places_.subspan(row * stride_, stride_);
  }

  /// Statistics of the drive that made the map; `frames() == 0` unless it was standardised.
  [[nodiscard]] const RunningStatistics& statistics() const noexcept { return statistics_; }

 private:
  PlaceMap(const Capacity& capacity, ArenaMemory&& memory);
  PlaceMap(Arena arena, const Capacity& capacity, ArenaMemory&& memory);

  ArenaMemory memory_;
  Capacity capacity_;
  std::size_t stride_;
  std::size_t size_ = 0;
  RunningStatistics statistics_;
  std::span<float> places_;  // [capacity, padded_size(D)]
};

}  // namespace seqloop
