// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/oracle.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::oracle {

/// What a detector was shown, frame by frame, and what each row of its map scores by definition at
/// the newest frame: without standardisation or enhancement. Which place a row holds is read off
/// the map, so that places may go.
class ShownDrive {
 public:
  /// @param reference the places to localise in; empty: loops are closed
  ShownDrive(const MatcherConfig& config, const PlaceMap& map, const Vectors& reference);

  /// @param descriptor empty: could not be read
  void step(const std::vector<float>& descriptor);
  void skip(std::uint64_t frames);

  /// Whether the window is full.
  [[nodiscard]] bool whole() const;

  /// Rows of the map that lines may touch.
  [[nodiscard]] std::int64_t rows() const;

  struct Scored {
    double score;
    std::int64_t head;  ///< row at the newest column
  };
  /// @return none where no line is valid
  [[nodiscard]] std::optional<Scored> score(std::int64_t row) const;

  /// The number of the place in a row.
  [[nodiscard]] std::uint64_t number(std::int64_t row) const;

  /// The row of the place with a number.
  [[nodiscard]] std::optional<std::int64_t> row_of(std::uint64_t number) const;

 private:
  [[nodiscard]] const Forms& place(std::int64_t row) const;

  const MatcherConfig& config_;
  const PlaceMap& map_;
  std::vector<Line> lines_;
  std::vector<Forms> reference_;
  std::vector<Forms> frames_;
  std::int64_t began_ = 0;
};

}  // namespace seqloop::oracle
