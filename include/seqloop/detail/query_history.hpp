// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"

namespace seqloop {

/// The newest query descriptors, a ring: what differences, scans of the map and the change degree
/// are computed from, and what becomes a place.
class QueryHistory {
 public:
  /// @param kept frames whose descriptors are kept, at least 1
  /// Allocates: from the arena only.
  QueryHistory(Arena& arena, const DescriptorForm& form, std::size_t kept)
      : kept_(kept),
        rows_(arena, {"query descriptors", "lengths of query descriptors", "query sketches"}, form,
              kept) {}

  /// Takes the next frame's descriptor, forgetting the oldest.
  /// @param descriptor [D] finite. Work: D. Allocates: never.
  void push(std::span<const float> descriptor) noexcept {
    rows_.store(row_of(frames_++), descriptor);
  }

  /// Takes another frame with the newest one's descriptor, or with none, all zero, if it is the
  /// first. Work: D copies. Allocates: never.
  void push_again() noexcept {
    const std::uint64_t frame = frames_++;
    if (frame > 0) rows_.copy(row_of(frame), rows_, row_of(frame - 1));
  }

  /// Frames pushed so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// The newest frame; there must be one.
  [[nodiscard]] std::uint64_t newest() const noexcept { return frames_ - 1; }

  /// The descriptors that are kept; a frame's row is `row_of(frame)`.
  [[nodiscard]] const DescriptorRows& rows() const noexcept { return rows_; }
  [[nodiscard]] std::size_t row_of(std::uint64_t frame) const noexcept {
    return static_cast<std::size_t>(frame % kept_);
  }

  /// The difference of two frames that are kept. Work: D MACs.
  [[nodiscard]] double between(std::uint64_t a, std::uint64_t b) const noexcept {
    return rows_.between(row_of(a), row_of(b));
  }

 private:
  std::size_t kept_;
  std::uint64_t frames_ = 0;
  DescriptorRows rows_;  // [kept]
};

}  // namespace seqloop
