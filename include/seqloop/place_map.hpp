// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"
#include "seqloop/detail/keyframes.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/detail/running_statistics.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// The places of one drive or several, in the order in which they were seen: R in the paper. The
/// places of a drive are a session. Room for all of them is taken at construction.
///
/// A detector refers to its map, which has to stay where it is. What was moved from may only be
/// destroyed, or be given another.
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
  /// @param zeroed whether that memory is known to be zero, as the system's new pages are: then it
  ///   is not written to here, and a page need not be there before a place is put in it
  /// Errors: SetupError, all faults at once.
  PlaceMap(const MatcherConfig& config, const Capacity& capacity, std::span<std::byte> memory = {},
           bool zeroed = false);

  /// Places that are added from here on are of another session: no line runs from one session into
  /// another. The first need not be begun. A detector that adds its drive begins one for it.
  /// @return false when there is no room for one more (`Capacity::sessions`). Allocates: never.
  [[nodiscard]] bool begin_session() noexcept;

  /// Whether another session can be begun.
  [[nodiscard]] bool has_room_for_session() const noexcept { return order_.has_room_for_session(); }

  /// Takes a place into the statistics that its session, and a drive to be localised in it, start
  /// from. Where nothing is known of descriptors (`set_statistics`), a drive may be shown to the
  /// map as a whole this way first, then `add`ed: so its first places are standardised as well as
  /// others.
  /// @return false when the session has places already, or the descriptor is of another size or not
  ///   finite, or nothing is to be standardised here (what a drive adds comes standardised): then
  ///   nothing has changed
  /// Work: D. Allocates: never.
  [[nodiscard]] bool learn(std::span<const float> descriptor) noexcept;

  /// Appends a place; standardised, if that is on, as a drive's frames are: by what the session has
  /// shown so far. Where sequences are made of keyframes (`has_keyframes`), others take no room:
  /// the numbers of those that follow leave theirs out.
  /// @param descriptor [D] as `Detector::step` takes it; only NaN and infinity are refused here,
  ///   and what else it would not take spoils the map. Of a frame that could not be read, give that
  ///   of the frame before it, or of the next where there is none: so places keep the numbers of
  ///   their frames. Not while a detector adds its drive, whose places would lose the numbers of
  ///   its frames
  /// @return false when the map is full, or the descriptor is of another size or not finite: then
  ///   nothing has changed
  /// Work: 9 D, and the sketch. Allocates: never.
  [[nodiscard]] bool add(std::span<const float> descriptor) noexcept;

  /// Numbers and frames lie below it.
  static constexpr std::uint64_t number_end = std::uint64_t{1} << 62U;

  /// A place as it was saved. What a map has to be saved with, for each row of it:
  /// `order().number(row)`, `order().frame(row)`, `first_visit(row)`, and the bytes that
  /// `rows().save(order().slot(row), bytes)` writes, `rows().saved_size()` of them; for each
  /// session its rows, `order().session(i)`; and `order().next_number()`, the mean, variance and
  /// frames of `statistics()`, or of the detector that added the newest session, and `columns()`. A
  /// map of the same configuration and capacity is made of that session by session: `count_from`
  /// its first number and `begin_session` (not for the first), `add_saved` and `set_first_visit` of
  /// its places; then `count_from` the next number, `set_statistics` and `set_columns`. A session
  /// of which no place is left is none any more.
  struct Saved {
    std::uint64_t number = 0;  ///< above that of the place before it, below `number_end`
    std::uint64_t frame = 0;   ///< of its session, above that of the place before it, as far below
    std::span<const std::byte> descriptor{};  ///< as `rows().save` gave it
  };

  /// Appends places that were saved, to the newest session. Which of them are visits of one place
  /// is restored by `link` or `set_first_visit`.
  /// @return how many; where not all, the map is full, or the next is none of a map of this form
  /// Work: D and the sketch of each; by thirty-twos, sketches take a tenth of the time.
  /// Allocates: never.
  [[nodiscard]] std::size_t add_saved(std::span<const Saved> places) noexcept;
  /// The same of one. @return false when nothing has changed
  [[nodiscard]] bool add_saved(const Saved& place) noexcept {
    return add_saved(std::span(&place, 1)) == 1;
  }

  /// Appends a place that was saved to a session that need not be the newest: what another robot
  /// has seen meanwhile. A detector at work on the map must take it in itself: `Detector::take_in`.
  /// @param session that has places, or the newest; another than that only where `FullMap` is not
  ///   `refuse`: search keeps no room for maps out of order
  /// @param place whose number is below that of the next session's first: leave room by
  ///   `count_from` before that is begun
  /// @return its row, from which on rows are counted one higher; none as `add_saved` is false, and
  ///   for a session that is not there
  /// Work: as `add_saved`, and 2 N bytes moved. Allocates: never.
  [[nodiscard]] std::optional<std::size_t> add_saved_to(std::size_t session,
                                                        const Saved& place) noexcept;

  /// The next place gets this number, or a higher one if that is its turn: places that went from a
  /// map that was saved do not give theirs to others. @param number `number_end` at most
  void count_from(std::uint64_t number) noexcept { order_.count_from(number); }

  /// Takes over the statistics of the newest session, or what is known of descriptors before there
  /// is one: a new drive starts from them.
  /// @param mean, variance [D] finite, variances from 0   @param frames 1 or more
  /// @return false when they are not like that, or nothing is to be standardised: then nothing has
  ///   changed
  [[nodiscard]] bool set_statistics(std::span<const double> mean, std::span<const double> variance,
                                    std::uint64_t frames) noexcept;

  /// What `take` did to the rows.
  struct Taken {
    std::optional<std::size_t> slot;     ///< where the place is now; none: refused
    std::optional<std::size_t> removed;  ///< the row that went for it
    bool forgotten = false;  ///< that was the map's first, or its session's last: no row behind it
                             ///< shows much the same, as where the map is thinned out
  };

  /// Appends what a detector compares its frames by; a full map does as `FullMap` says.
  /// @param frame of the session
  /// @param keep  newest rows that do not go
  /// Work: a copy; where places go, order is kept by moving 2 N bytes at most, and `thin` compares
  /// two descriptors. Allocates: never.
  Taken take(const DescriptorRows& queries, std::size_t query, std::uint64_t frame,
             std::size_t keep) noexcept;

  /// Rows so near each other are one place.
  static constexpr std::uint64_t beside = 10;

  /// From this probability on a frame is taken for a visit of the place that it was at.
  static constexpr double likely = 0.9;

  /// Between two rows that are linked, so near each other, all are.
  static constexpr std::size_t most_between = 40;

  /// Two rows are visits of one place. Rows between this one and the last that was linked are too,
  /// where both lie close together. A detector that decides by probability links what is `likely`
  /// by its frames alone, at most `patience` frames and as many rows later. Work: as many rows as
  /// lie between, `most_between` at most. Allocates: never.
  void link(std::size_t row, std::size_t earlier) noexcept;

  /// The number of the first place that this one is a visit of; its own where it was not linked.
  [[nodiscard]] std::uint64_t first_visit(std::size_t row) const noexcept {
    return first_visits_.empty() ? order_.number(row) : first_visits_[order_.slot(row)];
  }

  /// Whether visits of one place are linked, as where the probability decides.
  [[nodiscard]] bool knows_visits() const noexcept { return !first_visits_.empty(); }

  /// What `first_visit` gives from here on: as it was before the map was saved, or as a
  /// `VisitFinder` found it.
  void set_first_visit(std::size_t row, std::uint64_t number) noexcept {
    if (!first_visits_.empty()) first_visits_[order_.slot(row)] = number;
  }

  /// The robot stands at the newest place: so many frames more are of it, and become none.
  void stand(std::uint64_t frames) noexcept {
    if (stood_.empty() || size() == 0) return;
    std::uint32_t& stood = stood_[order_.slot(size() - 1)];
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    stood = static_cast<std::uint32_t>(std::min(most, stood + std::min(most, frames)));
  }

  /// Frames after a place's own at which the robot stood there. None are known of places that were
  /// saved, and in a map that has room for several sessions: there places are what is told, not
  /// frames.
  [[nodiscard]] std::uint64_t stood(std::size_t row) const noexcept {
    return stood_.empty() ? 0 : stood_[order_.slot(row)];
  }

  /// The `StopRun` of places that one is part of, or is beside.
  /// Work: `StopRun::around`. Allocates: never.
  [[nodiscard]] std::optional<CandidateRun> stop_at(std::size_t row) const noexcept;

  /// Whether every place that was ever between two rows still is: where the map has been thinned
  /// out, rows are further apart than the frames that they were. Of places that were saved nobody
  /// knows: in a map that thins out, those whose numbers do not follow each other count as if some
  /// had gone, in others all as if none had.
  /// @param first, last rows of one session, `first` the lower. Work: last - first.
  [[nodiscard]] bool has_all(std::size_t first, std::size_t last) const noexcept;

  /// Whether two rows are one place, or lie beside it: near each other, or their first visits are.
  [[nodiscard]] bool same_place(std::size_t a, std::size_t b) const noexcept {
    return order_.apart(a, b) <= beside || (!first_visits_.empty() && same_first_visit(a, b));
  }

  [[nodiscard]] std::size_t size() const noexcept { return order_.size(); }  // N
  [[nodiscard]] std::size_t capacity() const noexcept { return order_.capacity(); }
  [[nodiscard]] std::size_t descriptor_size() const noexcept { return rows_.form().size; }

  /// Which row is in which slot of `rows()`.
  [[nodiscard]] const PlaceOrder& order() const noexcept { return order_; }

  /// The descriptors, by slot.
  [[nodiscard]] const DescriptorRows& rows() const noexcept { return rows_; }

  [[nodiscard]] FullMap full_map() const noexcept { return full_map_; }

  /// The values of a descriptor stand in rows of so many, side by side across the picture, as those
  /// of a network's last axis do. Detectors that are made from here on can tell then, and allow for
  /// it, that the robot drives beside its old track, or that its camera has been turned
  /// (src/README.md, section 5.13).
  /// @param columns that the descriptor's size is a multiple of; 0: not known, as at first
  /// @return false where it is not: then nothing has changed. Allocates: never.
  bool set_columns(std::size_t columns) noexcept {
    if (columns > 0 && descriptor_size() % columns != 0) return false;
    columns_ = columns;
    return true;
  }
  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }

  /// Whether its places are standardised. Those are not that `add` gave a map which was made for
  /// one drive that closes loops: only its detector standardises that.
  [[nodiscard]] bool standardises() const noexcept { return standardisation_.on && !holds_raw_; }

  /// Statistics of the newest session that has any: a drive starts from them. A session that a
  /// detector has added has those of `Detector::statistics`, once `set_statistics` was given them.
  /// `frames() == 0` where nothing was learnt.
  [[nodiscard]] const RunningStatistics& statistics() const noexcept { return statistics_; }

 private:
  PlaceMap(const MatcherConfig& config, const Capacity& capacity, ArenaMemory&& memory,
           bool zeroed);
  PlaceMap(Arena arena, const MatcherConfig& config, const Capacity& capacity,
           ArenaMemory&& memory);

  [[nodiscard]] bool same_first_visit(std::size_t a, std::size_t b) const noexcept {
    const std::uint64_t first = first_visit(a);
    const std::uint64_t second = first_visit(b);
    return (first < second ? second - first : first - second) <= beside &&
           (order_.sessions() == 1 ||
            order_.session_of_number(first) == order_.session_of_number(second));
  }
  [[nodiscard]] bool fits(std::span<const float> descriptor) const noexcept;
  [[nodiscard]] std::optional<std::size_t> row_to_go(std::size_t keep) noexcept;
  [[nodiscard]] std::size_t append(std::uint64_t frame, std::uint64_t number) noexcept;
  void space(std::size_t row) noexcept;
  [[nodiscard]] std::optional<std::size_t> insert_unsketched(std::size_t session,
                                                             const Saved& place) noexcept;

  ArenaMemory memory_;
  Standardisation standardisation_;
  bool holds_raw_ = false;  // places that nobody has standardised
  FullMap full_map_;
  std::size_t columns_ = 0;  // of a descriptor's values
  bool learning_ = false;    // the newest session, which has no place yet
  RunningStatistics statistics_;
  RunningStatistics added_;  // of the places that are added, as a drive's
  bool has_keyframes_;
  Keyframes keyframes_;          // of what is added
  std::uint64_t no_places_ = 0;  // frames since the last of these
  PlaceOrder order_;
  DescriptorRows rows_;
  std::span<float> standardised_;         // [D]
  std::span<std::uint8_t> side_by_side_;  // places while their sketches are made
  std::size_t hand_ = 0;                  // thinning goes round the rows from here
  // [capacity] by slot, for thinning: difference to the row before, infinite to another session's
  std::span<float> spacing_;
  std::span<std::uint8_t> thinned_;        // [capacity] by slot: whether places before it have gone
  std::span<std::uint64_t> first_visits_;  // [capacity] by slot
  std::optional<std::size_t> last_linked_;  // row
  std::span<std::uint32_t> stood_;  // [capacity] by slot: frames behind it that are no places
};

}  // namespace seqloop
