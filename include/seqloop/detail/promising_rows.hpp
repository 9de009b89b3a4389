#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/difference_slices.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Keeps an eye on the whole map, so that a robot that has been carried elsewhere, or whose way
/// joins an earlier one, is found again without ever searching all rows: each frame looks at one
/// slice of the map, by sketches of a few of the newest frames, and remembers the rows that look
/// most alike. What is remembered is looked at again at every frame, and moves along with the
/// robot.
class PromisingRows {
 public:
  /// How many are remembered.
  static constexpr std::size_t most = 16;

  /// Allocates: from the arena only.
  PromisingRows(Arena& arena, const MatcherConfig& config, std::size_t places);

  /// Pairs of sketches that one call compares.
  struct Looks {
    std::size_t scanned;  ///< by their first words, over the slice
    std::size_t closely;  ///< by more of them
  };
  [[nodiscard]] static Looks most_looks(const MatcherConfig& config, std::size_t places) noexcept;

  /// Looks again at what is remembered, then at the next slice.
  /// @param rows   rows of the map that may be searched
  /// @param oldest the oldest frame that belongs together with the newest
  /// Work: what it returns. Allocates: never.
  Looks look(const DifferenceSlices& slices, const PlaceMap& map, std::size_t rows,
             std::uint64_t oldest) noexcept;

  /// A line that the frames of the window may have taken through the map.
  struct Promise {
    double difference;   ///< about the mean difference along it, as its sketches tell; 0 .. 2
    std::size_t centre;  ///< the row at the window's centre column
  };

  /// @return the most alike first
  [[nodiscard]] std::span<const Promise> promises() const noexcept {
    return promises_.first(count_);
  }

  /// Frames went by unseen: what is remembered is taken to lie so many rows further on.
  void skip(std::uint64_t frames) noexcept;

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept;

  /// Forgets everything.
  void restart() noexcept { count_ = 0; }

 private:
  /// A row that the newest frame may show.
  struct Alike {
    std::uint32_t bits;  // that differ, summed over the frames that were looked at
    std::size_t row;
  };

  [[nodiscard]] std::span<const Alike> best_of_slice(const DifferenceSlices& slices,
                                                     const PlaceMap& map,
                                                     std::size_t rows) noexcept;
  void look_closely(const DifferenceSlices& slices, const PlaceMap& map, std::size_t rows,
                    std::size_t row) noexcept;
  void bring(const PlaceMap& map, std::size_t rows, std::size_t row) const noexcept;
  void scan(const DifferenceSlices& slices, const PlaceMap& map, std::size_t first,
            std::span<std::uint32_t> bits) noexcept;
  [[nodiscard]] std::uint32_t differing_bits(const DifferenceSlices& slices, const PlaceMap& map,
                                             std::size_t rows, std::size_t back, std::size_t row,
                                             std::size_t behind) noexcept;
  [[nodiscard]] std::size_t rows_behind(std::size_t line, std::size_t back) const noexcept {
    return behind_[line * (ds_ + 1) + back];
  }
  void remember(Alike alike) noexcept;
  void weigh(const DifferenceSlices& slices, const PlaceMap& map, std::size_t rows,
             std::uint64_t oldest) noexcept;
  [[nodiscard]] std::size_t best_line(const DifferenceSlices& slices, const PlaceMap& map,
                                      std::size_t rows, std::size_t row,
                                      std::size_t reach) noexcept;

  std::size_t ds_;
  std::size_t slice_;
  std::size_t near_;        // rows within which there is one promise
  std::size_t next_ = 0;    // row that the next slice begins at
  std::size_t frames_ = 0;  // newest frames that are looked at now
  std::size_t scanned_ = 0;
  std::size_t sketches_ = 0;
  std::size_t count_ = 0;
  std::span<Alike> remembered_;    // [most], best first
  std::span<Alike> best_;          // of the slice, best first
  std::span<Promise> promises_;    // [most], what is remembered along the window, best first
  std::span<std::uint32_t> bits_;  // [slice] of the newest frame
  // [lines, ds + 1]: rows that a line lies behind its newest one, so many frames before the newest
  std::span<std::uint32_t> behind_;
};

}  // namespace seqloop
