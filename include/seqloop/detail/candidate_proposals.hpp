// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Proposes candidates from the whole map, so that a robot that has been carried elsewhere, or
/// whose path joins an earlier one, is found again without ever searching all rows. Each frame
/// scans a part of the map, by sketches of a few of the newest frames, and remembers the rows that
/// look most alike. Remembered rows are looked at again at every frame, and move along with the
/// robot. Source: src/README.md, section 5.4.
class CandidateProposals {
 public:
  /// How many are remembered.
  static constexpr std::size_t most = 16;

  /// Allocates: from the arena only.
  CandidateProposals(Arena& arena, const MatcherConfig& config, std::size_t places);

  /// Pairs of sketches that one call compares.
  struct Looks {
    std::size_t scanned;  ///< by their first words, in the scan
    std::size_t closely;  ///< by more of them
  };
  [[nodiscard]] static Looks most_looks(const MatcherConfig& config, std::size_t places) noexcept;

  /// Looks again at what is remembered, then scans the next rows. Where all rows are candidates it
  /// only scans.
  /// @param rows   rows of the map that may be searched
  /// @param newest the frame that is looked for
  /// @param oldest the oldest frame that belongs together with the newest
  /// Work: what it returns. Allocates: never.
  Looks look(const QueryHistory& queries, const PlaceMap& map, std::size_t rows,
             std::uint64_t newest, std::uint64_t oldest) noexcept;

  /// Of the rows that the last call scanned, in turn: how many bits of the scanned words differ.
  [[nodiscard]] std::span<const std::uint32_t> scanned() const noexcept { return scan_; }

  /// A row that the newest frame may show.
  struct Alike {
    std::uint32_t bits;  ///< that differ, summed over the frames that were looked at
    std::size_t row;
  };

  /// @return the rows of that scan that are most alike, no neighbours among them
  [[nodiscard]] std::span<const Alike> found() const noexcept { return best_.first(found_); }

  /// A line that the frames of the window may have taken through the map.
  struct Proposal {
    double difference;   ///< about the mean difference along it, as its sketches tell; 0 .. 2
    std::size_t centre;  ///< the row at the window's centre column
  };

  /// @return the most alike first
  [[nodiscard]] std::span<const Proposal> proposals() const noexcept {
    return proposals_.first(count_);
  }

  /// Frames went by unseen: each moves what is remembered one row further on, within its session.
  void skip(const PlaceOrder& order, std::uint64_t frames) noexcept;

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

  /// Forgets everything.
  void restart() noexcept { count_ = 0; }

 private:
  [[nodiscard]] std::span<const Alike> best_of_scan(const QueryHistory& queries,
                                                    const PlaceMap& map, std::size_t rows) noexcept;
  void look_closely(const QueryHistory& queries, const PlaceMap& map, std::size_t rows,
                    std::size_t row) noexcept;
  void prefetch(const PlaceMap& map, std::size_t rows, std::size_t row) const noexcept;
  void scan(const QueryHistory& queries, const PlaceMap& map, std::size_t first,
            std::span<std::uint32_t> bits) noexcept;
  [[nodiscard]] CloseSketch frame_before(const QueryHistory& queries,
                                         std::size_t back) const noexcept;
  [[nodiscard]] std::uint32_t differing_bits(const PlaceMap& map, CloseSketch frame,
                                             std::size_t first, std::size_t row,
                                             std::size_t behind) noexcept;
  [[nodiscard]] std::size_t rows_behind(std::size_t line, std::size_t back) const noexcept {
    return behind_[line * (ds_ + 1) + back];
  }
  void remember(const PlaceOrder& order, Alike alike) noexcept;
  void weigh(const QueryHistory& queries, const PlaceMap& map, std::uint64_t oldest) noexcept;
  [[nodiscard]] std::size_t best_line(const QueryHistory& queries, const PlaceMap& map,
                                      std::size_t first, std::size_t row,
                                      std::size_t reach) noexcept;

  std::size_t ds_;
  std::size_t rows_a_scan_;
  std::size_t near_;  // rows within which only one is remembered
  bool proposes_;
  std::size_t next_ = 0;    // row that the next scan begins at
  std::size_t frames_ = 0;  // newest frames that are looked at now
  std::size_t scanned_ = 0;
  std::size_t sketches_ = 0;
  std::size_t count_ = 0;
  std::size_t found_ = 0;
  std::uint64_t newest_ = 0;
  std::span<const std::uint32_t> scan_;
  std::span<Alike> remembered_;    // [most], best first
  std::span<Alike> best_;          // of the scan, best first
  std::span<Proposal> proposals_;  // [most], what is remembered along the window, best first
  std::span<std::uint32_t> bits_;  // [rows_a_scan] of the newest frame
  // [lines, ds + 1]: how many rows before its newest one a line is, that many frames earlier
  std::span<std::uint32_t> behind_;
};

}  // namespace seqloop
