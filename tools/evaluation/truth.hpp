// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "evaluation/csv.hpp"
#include "evaluation/positions.hpp"

namespace seqloop::evaluation {

/// What an answer to a query is that a truth does not list.
enum class Unlisted : std::uint8_t {
  wrong,   ///< the truth lists every query that has a place
  unknown  ///< nobody looked: neither right nor wrong
};

/// How many rows of a truth say themselves how far off a match may be.
enum class OwnTolerances : std::uint8_t { none, some, all };

/// Which places each query frame really shows.
class Truth {
 public:
  /// Frame i shows place i, for i in [0, frames).
  static Truth identity(std::uint64_t frames);

  /// No frame shows a place that was seen before: every answer is wrong.
  static Truth no_revisit() { return {}; }

  /// A route of `frames` frames, driven `laps` times in one drive: frame i of a lap shows the
  /// places of frame i of the laps before. The first lap is new.
  static Truth laps(std::uint64_t frames, std::uint64_t laps);

  /// Rows `query,reference`; several rows of one query are several right answers. A third column
  /// `tolerance`, in frames, holds for its own row, unless its cell is empty, instead of the
  /// tolerance that `right` is asked with. Throws SetupError as CsvTable does, and without rows.
  static Truth from_csv(const CsvTable& table, Unlisted unlisted = Unlisted::wrong);

  /// A query frame shows every reference frame that was at most the radius away; one that was near
  /// none is listed, and new. There is no tolerance in frames beside that.
  /// @param radius_m metres, > 0: over the ground, along a great circle, where positions are on
  /// earth
  /// Work: sorts both; a distance for each query and each reference in its band of the radius.
  /// Throws SetupError: the radius; one drive is on earth and the other on a plan; no query frame
  /// is within the radius of a reference frame.
  static Truth from_positions(Positions reference, const Positions& query, double radius_m,
                              Unlisted unlisted = Unlisted::wrong);

  /// Loops within one drive: a frame shows every earlier one that was at most the radius away, if
  /// the robot was farther away than that in between. Otherwise it is as above.
  /// Work: as above, and a distance for each frame since the robot came near.
  /// Throws SetupError: the radius; no frame comes back.
  static Truth loops_from_positions(const Positions& drive, double radius_m,
                                    Unlisted unlisted = Unlisted::wrong);

  /// Frames that have a place.
  [[nodiscard]] std::uint64_t frames() const noexcept;

  /// One more than the highest frame that it names, of the queries and of the references.
  [[nodiscard]] std::uint64_t queries_reach() const noexcept;
  [[nodiscard]] std::uint64_t places_reach() const noexcept;

  /// Whether an answer is either right or wrong.
  [[nodiscard]] bool judges(std::uint64_t query, std::uint64_t match) const noexcept {
    return unlisted_ == Unlisted::wrong || (places_.contains(query) && knows(match));
  }

  /// Whether it is known where a place is: all are, but by positions those that have one.
  [[nodiscard]] bool knows(std::uint64_t place) const noexcept {
    return !known_ || known_->contains(place);
  }

  /// Where it is all of them, no asked tolerance counts.
  [[nodiscard]] OwnTolerances own_tolerances() const noexcept { return own_tolerances_; }

  /// @param tolerance frames
  [[nodiscard]] bool right(std::uint64_t query, std::uint64_t match,
                           std::uint64_t tolerance) const noexcept;

 private:
  /// Neighbouring reference frames that are all right.
  struct Run {
    std::uint64_t first;
    std::uint64_t last;
    std::optional<std::uint64_t> tolerance = {};  ///< frames; the asked one when it has none
  };

  /// @param frames ascending
  static std::vector<Run> runs_of(std::span<const std::uint64_t> frames);

  static std::set<std::uint64_t> frames_of(const Positions& positions);

  std::optional<std::uint64_t> identity_frames_;      // set: frame i shows place i
  std::map<std::uint64_t, std::vector<Run>> places_;  // of a query that is new: none
  std::optional<std::set<std::uint64_t>> known_;      // places; unset: all
  Unlisted unlisted_ = Unlisted::wrong;
  OwnTolerances own_tolerances_ = OwnTolerances::none;
};

}  // namespace seqloop::evaluation
