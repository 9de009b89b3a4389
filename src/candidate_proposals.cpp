// SPDX-License-Identifier: MIT
#include "seqloop/detail/candidate_proposals.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "seqloop/detail/keep_lowest.hpp"
#include "seqloop/detail/kept_row.hpp"

namespace seqloop {
namespace {

// A scanned row is first compared with the newest frame alone. The best few rows, and those that
// are remembered, are then compared with some earlier frames too, far enough apart to differ.
constexpr std::size_t frames_looked_at = 4;
constexpr std::size_t frames_apart = 3;
constexpr std::size_t looked_at_closely = 16;

// The robot may be faster or slower than it was in the map.
constexpr std::size_t slack = 1;

// Through each remembered row `lines_tried` lines are compared at the ends of `pieces_tried`
// pieces. The best one is then weighed by every `frames_between`-th frame of the window: a row that
// is no candidate can be the runner-up by that weight.
constexpr std::size_t lines_tried = 9;
constexpr std::size_t pieces_tried = 8;
constexpr std::size_t frames_between = 2;

// Of this many neighbouring rows of a scan only the best is looked at closely.
constexpr std::size_t neighbours = 16;

// Bits that differ between pictures that have nothing in common.
constexpr std::uint32_t chance = DescriptorRows::close_words * 64 / 2;

/// Of a number known here, so that they are compared side by side; signed, as every processor can.
std::uint32_t least_of(std::span<const std::uint32_t, neighbours> bits) {
  auto least = static_cast<std::int32_t>(bits[0]);
  for (const std::uint32_t b : bits) least = std::min(least, static_cast<std::int32_t>(b));
  return static_cast<std::uint32_t>(least);
}

std::size_t rows_a_scan(const MatcherConfig& config, std::size_t places) {
  return std::min(config.relocalising.rows_scanned, places);
}

/// Where all rows are candidates, there is nothing to propose.
bool proposes(const MatcherConfig& config) {
  return scans(config) && config.candidates != Candidates::all;
}

}  // namespace

CandidateProposals::CandidateProposals(Arena& arena, const MatcherConfig& config,
                                       std::size_t places)
    : ds_(config.sequence_length),
      rows_a_scan_(rows_a_scan(config, places)),
      near_(config.num / 2),
      proposes_(proposes(config)) {
  const bool used = scans(config);
  remembered_ = arena.take<Alike>("rows that look alike", proposes_ ? most : 0);
  proposals_ = arena.take<Proposal>("proposed lines", proposes_ ? most : 0);
  best_ = arena.take<Alike>("best rows of a scan", used ? looked_at_closely : 0);
  bits_ = arena.take<std::uint32_t>("differing bits of a scan", used ? rows_a_scan_ : 0);
  behind_ = arena.take<std::uint32_t>("lines tried", proposes_ ? lines_tried * (ds_ + 1) : 0);
  if (!proposes_ || arena.measuring()) return;
  for (std::size_t line = 0; line < lines_tried; ++line) {
    const double velocity = config.vmin + (config.vmax - config.vmin) * static_cast<double>(line) /
                                              static_cast<double>(lines_tried - 1);
    for (std::size_t back = 0; back <= ds_; ++back) {
      constexpr double half = 0.5;
      behind_[line * (ds_ + 1) + back] =
          static_cast<std::uint32_t>(velocity * static_cast<double>(back) + half);
    }
  }
}

CandidateProposals::Looks CandidateProposals::most_looks(const MatcherConfig& config,
                                                         std::size_t places) noexcept {
  if (!proposes(config)) return {rows_a_scan(config, places), 0};
  return {
      rows_a_scan(config, places),
      (most + looked_at_closely) * (2 * slack + 1) * frames_looked_at +
          most * (lines_tried * (pieces_tried + 1) + config.sequence_length / frames_between + 1)};
}

CandidateProposals::Looks CandidateProposals::look(const QueryHistory& queries, const PlaceMap& map,
                                                   std::size_t rows, std::uint64_t newest,
                                                   std::uint64_t oldest) noexcept {
  scanned_ = 0;
  sketches_ = 0;
  newest_ = newest;
  frames_ = std::min<std::size_t>(frames_looked_at,
                                  static_cast<std::size_t>((newest - oldest) / frames_apart) + 1);

  const std::size_t before = std::exchange(count_, 0);
  for (std::size_t i = 0; i < before; ++i) {
    // What is remembered goes where count_ is or before, which has been read already.
    const std::size_t row = remembered_[i].row;
    if (map.order().apart(row, row + 1) == 1) look_closely(queries, map, rows, row + 1);
  }
  const std::span<const Alike> found = best_of_scan(queries, map, rows);
  if (!proposes_) return {scanned_, 0};
  for (const Alike& best : found) prefetch(map, rows, best.row);
  for (const Alike& best : found) {
    look_closely(queries, map, rows, best.row);
  }
  weigh(queries, map, oldest);
  return {scanned_, sketches_};
}

/// The rows of the next scan that look most like the newest frame, one at most of each group of
/// neighbours.
std::span<const CandidateProposals::Alike> CandidateProposals::best_of_scan(
    const QueryHistory& queries, const PlaceMap& map, std::size_t rows) noexcept {
  scan_ = {};
  found_ = 0;
  if (rows == 0) return {};
  // Scans go round: after the last row comes the first, and none is longer than the map.
  const std::size_t begin = next_ % rows;
  const std::span<std::uint32_t> bits = bits_.first(std::min(rows_a_scan_, rows));
  const std::size_t to_the_end = std::min(bits.size(), rows - begin);
  scan(queries, map, begin, bits.first(to_the_end));
  scan(queries, map, 0, bits.subspan(to_the_end));
  scan_ = bits;
  next_ = (begin + bits.size()) % rows;
  std::size_t found = 0;
  for (std::size_t first = 0; first < bits.size(); first += neighbours) {
    const auto some = bits.subspan(first, std::min(neighbours, bits.size() - first));
    const std::uint32_t least = some.size() == neighbours ? least_of(some.first<neighbours>())
                                                          : *std::ranges::min_element(some);
    if (found == looked_at_closely && least >= best_[found - 1].bits) continue;
    const auto where = std::distance(some.begin(), std::ranges::find(some, least));
    const std::size_t row = (begin + first + static_cast<std::size_t>(where)) % rows;
    found = keep_lowest(best_, found, {least, row}, &Alike::bits);
  }
  found_ = found;
  return best_.first(found);
}

/// Compares the newest frame with consecutive rows.
void CandidateProposals::scan(const QueryHistory& queries, const PlaceMap& map, std::size_t first,
                              std::span<std::uint32_t> bits) noexcept {
  const std::size_t query = queries.row_of(newest_);
  map.order().in_slots(
      first, first + bits.size(), [&](std::size_t row, std::size_t slot, std::size_t count) {
        map.rows().scan(queries.moved(), query, slot, bits.subspan(row - first, count));
      });
  scanned_ += bits.size();
}

/// Compares a row and those beside it with several frames, and remembers the best of them.
void CandidateProposals::look_closely(const QueryHistory& queries, const PlaceMap& map,
                                      std::size_t rows, std::size_t row) noexcept {
  if (row >= rows) return;
  const CandidateRun session = map.order().around(row);
  const std::size_t first = map.order().before(row, slack);
  const std::size_t last = std::min({row + slack + 1, rows, session.last});
  std::array<std::uint32_t, 2 * slack + 1> sums{};
  for (std::size_t frame = 0; frame < frames_; ++frame) {
    const std::size_t back = frame * frames_apart;
    const CloseSketch sketch = frame_before(queries, back);
    for (std::size_t r = first; r < last; ++r) {
      sums[r - first] += differing_bits(map, sketch, session.first, r, back);
    }
  }
  Alike best{std::numeric_limits<std::uint32_t>::max(), row};
  for (std::size_t r = first; r < last; ++r) {
    if (sums[r - first] < best.bits) best = {sums[r - first], r};
  }
  remember(map.order(), best);
}

/// Has the processor fetch what looking closely at a row will read: it is in no cache.
void CandidateProposals::prefetch(const PlaceMap& map, std::size_t rows,
                                  std::size_t row) const noexcept {
  const std::size_t reach = slack + (frames_ - 1) * frames_apart;
  map.order().in_slots(row - std::min(row, reach), std::min(row + slack + 1, rows),
                       [&](std::size_t, std::size_t slot, std::size_t count) {
                         map.rows().prefetch_sketches(slot, count);
                       });
}

/// The sketch of the frame `back` frames before the newest.
CloseSketch CandidateProposals::frame_before(const QueryHistory& queries,
                                             std::size_t back) const noexcept {
  return queries.moved().close_sketch(queries.row_of(newest_ - back));
}

/// Differing bits of a frame and the row `behind` rows before `row`; one that its session, which
/// begins at the row `first`, has not differs as much as by chance.
std::uint32_t CandidateProposals::differing_bits(const PlaceMap& map, CloseSketch frame,
                                                 std::size_t first, std::size_t row,
                                                 std::size_t behind) noexcept {
  if (behind > row - first) return chance;
  ++sketches_;
  return map.rows().look_closely(frame, map.order().slot(row - behind));
}

/// Keeps a row if it is among the best, and only the best of those that are near each other.
void CandidateProposals::remember(const PlaceOrder& order, Alike alike) noexcept {
  const auto begin = remembered_.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count_);
  const auto near = std::find_if(
      begin, end, [&](const Alike& other) { return order.apart(other.row, alike.row) <= near_; });
  if (near != end) {
    if (near->bits <= alike.bits) return;
    std::move(near + 1, end, near);
    --count_;
  }
  count_ = keep_lowest(remembered_, count_, alike, &Alike::bits);
}

/// Weighs what is remembered along the whole window.
void CandidateProposals::weigh(const QueryHistory& queries, const PlaceMap& map,
                               std::uint64_t oldest) noexcept {
  const auto reach = static_cast<std::size_t>(std::min<std::uint64_t>(newest_ - oldest, ds_));
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t row = remembered_[i].row;
    const std::size_t first = map.order().around(row).first;
    const std::size_t line = best_line(queries, map, first, row, reach);
    std::uint32_t bits = 0;
    for (std::size_t back = 0; back <= reach; back += frames_between) {
      bits += differing_bits(map, frame_before(queries, back), first, row, rows_behind(line, back));
    }
    const std::size_t frames = reach / frames_between + 1;
    const Proposal proposal{
        chord(static_cast<double>(bits) / (2.0 * chance * static_cast<double>(frames))),
        map.order().before(row, rows_behind(line, ds_ - ds_ / 2))};
    keep_lowest(proposals_, i, proposal, &Proposal::difference);
  }
}

/// Of the lines that end at a row, the one that looks most alike at a few frames of the window.
/// @param first row of its session
std::size_t CandidateProposals::best_line(const QueryHistory& queries, const PlaceMap& map,
                                          std::size_t first, std::size_t row,
                                          std::size_t reach) noexcept {
  std::array<std::uint32_t, lines_tried> sums{};
  for (std::size_t piece = 0; piece <= pieces_tried; ++piece) {
    const std::size_t back = ds_ * piece / pieces_tried;
    if (back > reach) break;
    const CloseSketch frame = frame_before(queries, back);
    std::uint32_t bits = 0;
    auto before = std::numeric_limits<std::size_t>::max();
    for (std::size_t line = 0; line < lines_tried; ++line) {
      // Lines that are still together at this frame look at the same row.
      const std::size_t behind = rows_behind(line, back);
      if (behind != before) bits = differing_bits(map, frame, first, row, behind);
      before = behind;
      sums[line] += bits;
    }
  }
  return static_cast<std::size_t>(std::distance(sums.begin(), std::ranges::min_element(sums)));
}

void CandidateProposals::skip(const PlaceOrder& order, std::uint64_t frames) noexcept {
  const auto by = static_cast<std::size_t>(frames);
  const std::size_t before = std::exchange(count_, 0);
  for (std::size_t i = 0; i < before; ++i) {
    const Alike alike = remembered_[i];
    if (order.apart(alike.row, alike.row + by) != by) continue;
    remembered_[count_++] = {alike.bits, alike.row + by};
  }
}

void CandidateProposals::removed(std::size_t row) noexcept {
  for (Alike& alike : remembered_.first(count_)) {
    count_without(row, false, alike.row);
  }
  count_without(row, false, next_);
}

void CandidateProposals::inserted(std::size_t row) noexcept {
  for (Alike& alike : remembered_.first(count_)) {
    count_with(row, alike.row);
  }
  if (next_ > row) ++next_;
}

}  // namespace seqloop
