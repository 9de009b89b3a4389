#include "seqloop/promising_rows.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace seqloop {
namespace {

// A row of the slice is first compared with the newest frame alone. The best few of them, and what
// is remembered, are compared with some frames before it too, so far apart that they differ.
constexpr std::size_t frames_looked_at = 4;
constexpr std::size_t frames_apart = 3;
constexpr std::size_t looked_at_closely = 8;

// What is remembered may be faster or slower than it was in the map.
constexpr std::size_t slack = 1;

// Of so many neighbours in a slice only the best is looked at closely.
constexpr std::size_t neighbours = 16;

constexpr std::uint32_t chance =
    DescriptorRows::first_words * 64 / 2;  // bits that differ by chance

std::size_t slice_of(const MatcherConfig& config, std::size_t places) {
  return std::min(config.relocalising.slice, places);
}

}  // namespace

PromisingRows::PromisingRows(Arena& arena, const MatcherConfig& config, std::size_t places)
    : slice_(slice_of(config, places)), near_(config.num / 2) {
  const bool used = relocalises(config);
  promises_ = arena.take<Promise>("promising rows", used ? most + 1 : 0);
  best_ = arena.take<Promise>("best rows of a slice", used ? looked_at_closely + 1 : 0);
  bits_ = arena.take<std::uint32_t>("differing bits of a slice", used ? slice_ : 0);
}

std::size_t PromisingRows::most_sketches(const MatcherConfig& config, std::size_t places) noexcept {
  return slice_of(config, places) + (most + looked_at_closely) * (2 * slack + 1) * frames_looked_at;
}

std::size_t PromisingRows::look(const DifferenceSlices& slices, const PlaceMap& map,
                                std::size_t rows, std::uint64_t oldest) noexcept {
  sketches_ = 0;
  const std::uint64_t newest = slices.frames() - 1;
  frames_ = std::min<std::size_t>(frames_looked_at,
                                  static_cast<std::size_t>((newest - oldest) / frames_apart) + 1);

  const std::size_t before = std::exchange(count_, 0);
  for (std::size_t i = 0; i < before; ++i) {
    // What is remembered goes where count_ is or before, which has been read already.
    look_closely(slices, map, rows, promises_[i].row + 1);
  }
  for (const Promise& best : best_of_slice(slices, map, rows)) {
    look_closely(slices, map, rows, best.row);
  }
  return sketches_;
}

/// The rows of the next slice that look most like the newest frame, as far as they are no
/// neighbours.
std::span<const PromisingRows::Promise> PromisingRows::best_of_slice(const DifferenceSlices& slices,
                                                                     const PlaceMap& map,
                                                                     std::size_t rows) noexcept {
  if (rows == 0) return {};
  // The slices go round: behind the last row comes the first, and none is longer than the map.
  const std::size_t begin = next_ % rows;
  const std::span<std::uint32_t> bits = bits_.first(std::min(slice_, rows));
  const std::size_t to_the_end = std::min(bits.size(), rows - begin);
  compare(slices, map, 0, begin, bits.first(to_the_end));
  compare(slices, map, 0, 0, bits.subspan(to_the_end));
  next_ = (begin + bits.size()) % rows;
  std::size_t found = 0;
  for (std::size_t first = 0; first < bits.size(); first += neighbours) {
    const auto some = bits.subspan(first, std::min(neighbours, bits.size() - first));
    const auto least = std::ranges::min_element(some);
    if (found == looked_at_closely && *least >= best_[found - 1].bits) continue;
    std::size_t place = found;
    for (; place > 0 && best_[place - 1].bits > *least; --place) best_[place] = best_[place - 1];
    const auto row = begin + first + static_cast<std::size_t>(std::distance(some.begin(), least));
    best_[place] = {*least, row % rows};
    found = std::min(found + 1, looked_at_closely);
  }
  return best_.first(found);
}

/// Compares a row and those beside it with several frames, and remembers the best of them.
void PromisingRows::look_closely(const DifferenceSlices& slices, const PlaceMap& map,
                                 std::size_t rows, std::size_t row) noexcept {
  if (row >= rows) return;
  const std::size_t first = row - std::min(row, slack);
  const std::size_t count = std::min(row + slack + 1, rows) - first;
  std::array<std::uint32_t, 2 * slack + 1> sums{};
  for (std::size_t frame = 0; frame < frames_; ++frame) {
    // The rows that this frame would show if the newest one showed these.
    const std::size_t back = frame * frames_apart;
    const std::size_t missing = std::min(count, back - std::min(back, first));
    std::array<std::uint32_t, 2 * slack + 1> bits;
    bits.fill(chance);
    compare(slices, map, back, first + missing - back,
            std::span(bits).subspan(missing, count - missing));
    for (std::size_t i = 0; i < count; ++i) sums[i] += bits[i];
  }
  Promise best{sums[row - first], row};
  for (std::size_t i = 0; i < count; ++i) {
    if (sums[i] < best.bits) best = {sums[i], first + i};
  }
  remember(best);
}

/// Differing bits of a frame, so many before the newest, and consecutive rows.
void PromisingRows::compare(const DifferenceSlices& slices, const PlaceMap& map, std::size_t back,
                            std::size_t first, std::span<std::uint32_t> bits) noexcept {
  const std::size_t query = slices.row_of(slices.frames() - 1 - back);
  map.order().in_slots(first, first + bits.size(),
                       [&](std::size_t row, std::size_t slot, std::size_t count) {
                         map.rows().compare_first_words(slices.queries(), query, slot,
                                                        bits.subspan(row - first, count));
                       });
  sketches_ += bits.size();
}

/// Keeps a promise if it is among the best, and the best of those near it.
void PromisingRows::remember(Promise promise) noexcept {
  const auto begin = promises_.begin();
  auto end = begin + static_cast<std::ptrdiff_t>(count_);
  const auto near = std::find_if(begin, end, [&](const Promise& other) {
    return other.row <= promise.row + near_ && promise.row <= other.row + near_;
  });
  if (near != end) {
    if (near->bits <= promise.bits) return;
    std::move(near + 1, end, near);
    --end;
    --count_;
  }
  const auto place =
      std::find_if(begin, end, [&](const Promise& other) { return promise.bits < other.bits; });
  std::move_backward(place, end, end + 1);
  *place = promise;
  count_ = std::min(count_ + 1, most);
}

void PromisingRows::skip(std::uint64_t frames) noexcept {
  for (Promise& promise : promises_.first(count_)) {
    promise.row += static_cast<std::size_t>(frames);
  }
}

void PromisingRows::removed(std::size_t row) noexcept {
  for (Promise& promise : promises_.first(count_)) {
    if (promise.row > row) --promise.row;
  }
  if (next_ > row) --next_;
}

}  // namespace seqloop
