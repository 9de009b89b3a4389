// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/detail/running_statistics.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// The places of a drive, in the order in which they were seen: R in the paper. Room for all of
/// them is taken at construction.
class PlaceMap {
 public:
  /// Bytes of every buffer. Errors: SetupError, all faults at once.
  [[nodiscard]] static std::vector<BufferSize> plan(const MatcherConfig& config,
                                                    const Capacity& capacity);
  [[nodiscard]] static std::uint64_t bytes_needed(const MatcherConfig& config,
                                                  const Capacity& capacity) {
    return total_bytes(plan(config, capacity));
  }

  /// @param config what the detector will be given: it says in what form places are kept
  /// @param memory [bytes_needed(config, capacity)] aligned to Arena::alignment; empty: own memory
  /// Errors: SetupError, all faults at once.
  PlaceMap(const MatcherConfig& config, const Capacity& capacity, std::span<std::byte> memory = {});

  /// Takes a place into the statistics by which all of them are standardised. A map to localise in
  /// is shown its whole drive this way first, where the configuration standardises, then `add`s it.
  /// @return false when there are places already, or the descriptor is of another size or not
  ///   finite, or nothing is to be standardised: then nothing has changed
  /// Work: D. Allocates: never.
  [[nodiscard]] bool learn(std::span<const float> descriptor) noexcept;

  /// Appends a place; standardised, if the map has learnt.
  /// @param descriptor [D]; without NaN or infinity
  /// @return false when the map is full, or the descriptor is of another size or not finite: then
  ///   nothing has changed
  /// Work: 5 D. Allocates: never.
  [[nodiscard]] bool add(std::span<const float> descriptor) noexcept;

  /// What `take` did to the rows.
  struct Taken {
    std::optional<std::size_t> slot;     ///< where the place is now; none: refused
    std::optional<std::size_t> removed;  ///< the row that went for it
  };

  /// Appends what a detector compares its frames by; a full map does as `FullMap` says.
  /// @param keep newest rows that do not go
  /// Work: a copy; where places go, order is kept by moving 2 N bytes at most, and `thin` compares
  /// two descriptors. Allocates: never.
  Taken take(const DescriptorRows& queries, std::size_t query, std::size_t keep) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return order_.size(); }  // N
  [[nodiscard]] std::size_t capacity() const noexcept { return order_.capacity(); }
  [[nodiscard]] std::size_t descriptor_size() const noexcept { return rows_.form().size; }

  /// Which row is in which slot of `rows()`.
  [[nodiscard]] const PlaceOrder& order() const noexcept { return order_; }

  /// The descriptors, by slot.
  [[nodiscard]] const DescriptorRows& rows() const noexcept { return rows_; }

  [[nodiscard]] FullMap full_map() const noexcept { return full_map_; }

  /// Statistics of the drive that made the map; `frames() == 0` unless it has learnt.
  [[nodiscard]] const RunningStatistics& statistics() const noexcept { return statistics_; }

 private:
  PlaceMap(const MatcherConfig& config, const Capacity& capacity, ArenaMemory&& memory);
  PlaceMap(Arena arena, const MatcherConfig& config, const Capacity& capacity,
           ArenaMemory&& memory);

  [[nodiscard]] bool fits(std::span<const float> descriptor) const noexcept;
  [[nodiscard]] std::optional<std::size_t> row_to_go(std::size_t keep) noexcept;

  ArenaMemory memory_;
  bool standardises_;
  FullMap full_map_;
  RunningStatistics statistics_;
  PlaceOrder order_;
  DescriptorRows rows_;
  std::span<float> standardised_;  // [D]
  std::size_t hand_ = 0;           // thinning goes round the rows from here
  std::span<float> spacing_;       // [capacity] by slot: difference to the row before; for thinning
};

}  // namespace seqloop
