// SPDX-License-Identifier: MIT
#include "seqloop/detail/difference_slices.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace seqloop {
namespace {

/// What 1 is among enhanced whole numbers: as much as leaves the largest one below 65,535.
double unit_of(const MatcherConfig& config, const DescriptorForm& form) {
  if (config.arithmetic == Arithmetic::float32) return 1.0;
  constexpr double largest = 65'534.0;
  return config.enhance ? largest / Contrast(config.rwindow).largest() : form.unit();
}

std::size_t columns_of(const MatcherConfig& config) {
  return config.sequence_length + config.frames_at_once;
}

/// How far beyond its ends a column may be read: as far as the diagonals around a row's own leave
/// it within a window, and the rest of a vector.
std::size_t margin_of(const MatcherConfig& config) {
  constexpr double vector = 32.0;
  const std::size_t half = config.sequence_length / 2 + 1;
  const double beyond = static_cast<double>(half) * std::max(config.vmax, 2.0);
  return static_cast<std::size_t>(std::ceil(beyond + vector));
}

/// Rows and those around them that they are enhanced by, of their own sessions.
CandidateRun with_around(const PlaceOrder& order, std::size_t first, std::size_t last,
                         std::size_t reach) {
  if (reach == 0) return {first, last};
  return {order.before(first, reach), std::min(order.around(last - 1).last, last + reach)};
}

}  // namespace

DifferenceSlices::DifferenceSlices(Arena& arena, const MatcherConfig& config,
                                   const QueryHistory& queries, const Capacity& capacity)
    : whole_(config.arithmetic != Arithmetic::float32),
      enhance_(config.enhance),
      contrast_(config.rwindow),
      unit_(unit_of(config, DescriptorForm(config, capacity.descriptor_size))),
      queries_(&queries),
      exact_(arena, "difference slices", "filled parts of the slices",
             whole_ ? 0 : columns_of(config), capacity.places, margin_of(config)),
      enhanced_(arena, "enhanced slices", "filled parts of the enhanced slices",
                whole_ || !enhance_ ? 0 : columns_of(config), capacity.places, margin_of(config)),
      whole_differences_(arena, "difference slices", "filled parts of the slices",
                         whole_ ? columns_of(config) : 0, capacity.places, margin_of(config)),
      whole_enhanced_(arena, "enhanced slices", "filled parts of the enhanced slices",
                      whole_ && enhance_ ? columns_of(config) : 0, capacity.places,
                      margin_of(config)) {}

void DifferenceSlices::repeat() noexcept {
  const std::uint64_t frame = queries_->newest();
  const auto repeat = [frame](auto& ring) { ring.repeat(frame); };
  if (whole_) {
    repeat(whole_differences_);
    if (enhance_) repeat(whole_enhanced_);
  } else {
    repeat(exact_);
    if (enhance_) repeat(enhanced_);
  }
}

template <class Value>
std::size_t DifferenceSlices::fill_in(ColumnRing<Value>& differences, ColumnRing<Value>& enhanced,
                                      const PlaceMap& map, std::uint64_t frame, std::size_t first,
                                      std::size_t last) noexcept {
  const std::size_t reach = enhance_ ? contrast_.reach() : 0;
  const CandidateRun wider = with_around(map.order(), first, last, reach);
  std::size_t computed = 0;
  map.order().in_slots(
      wider.first, wider.last, [&](std::size_t, std::size_t slot, std::size_t count) {
        computed += differences.fill(
            frame, slot, slot + count, [&](std::size_t begin, std::span<Value> out) {
              map.rows().compare(queries_->moved(), queries_->row_of(frame), begin, out);
            });
      });
  if (enhance_) {
    enhanced.fill(frame, first, last, [&](std::size_t begin, std::span<Value> out) {
      // Nothing goes from a map where this is asked for: rows are slots.
      const double scale = whole_ ? unit_ : 1.0;
      map.order().in_sessions({begin, begin + out.size()}, [&](CandidateRun part) {
        const CandidateRun session = map.order().around(part.first);
        const std::span<const Value> column(differences.column(frame) + session.first,
                                            session.last - session.first);
        for (std::size_t row = part.first; row < part.last; ++row) {
          out[row - begin] = contrast_.enhance(column, row - session.first, scale);
        }
      });
    });
  }
  return computed;
}

std::size_t DifferenceSlices::fill(const PlaceMap& map, std::uint64_t frame, std::size_t first,
                                   std::size_t last) noexcept {
  if (first >= last) return 0;
  return whole_ ? fill_in(whole_differences_, whole_enhanced_, map, frame, first, last)
                : fill_in(exact_, enhanced_, map, frame, first, last);
}

void DifferenceSlices::fill_newest(const PlaceMap& map, std::size_t count) noexcept {
  const std::uint64_t first = queries_->frames() - count;
  const auto fill = [&]<class Value>(ColumnRing<Value>& differences) {
    std::array<std::span<Value>, MatcherConfig::most_frames_at_once> columns;
    for (std::size_t i = 0; i < count; ++i) {
      columns[i] = differences.take_over(first + i, map.size());
    }
    const std::span<const std::span<Value>> newest = std::span(columns).first(count);
    map.rows().compare(queries_->moved(), queries_->row_of(first), newest);
  };
  if (whole_) {
    fill(whole_differences_);
  } else {
    fill(exact_);
  }
}

std::size_t DifferenceSlices::missing_anywhere(const PlaceMap& map, std::uint64_t frame,
                                               std::size_t first, std::size_t last) const noexcept {
  const std::size_t reach = enhance_ ? contrast_.reach() : 0;
  const CandidateRun wider = with_around(map.order(), first, last, reach);
  std::size_t count = 0;
  map.order().in_slots(wider.first, wider.last,
                       [&](std::size_t, std::size_t slot, std::size_t rows) {
                         count += whole_ ? whole_differences_.missing(frame, slot, slot + rows)
                                         : exact_.missing(frame, slot, slot + rows);
                       });
  return count;
}

void DifferenceSlices::forget(std::size_t slot) noexcept {
  if (whole_) {
    whole_differences_.forget(slot);
  } else {
    exact_.forget(slot);
  }
}

void DifferenceSlices::show(const PlaceMap& map, std::uint64_t frame,
                            std::span<float> out) const noexcept {
  const auto show = [&](const auto& ring) {
    for (std::size_t row = 0; row < out.size(); ++row) {
      const auto value = ring.value(frame, map.order().slot(row));
      out[row] = value == ring.not_computed
                     ? -1.0F
                     : static_cast<float>(static_cast<double>(value) / unit_);
    }
  };
  if (whole_) {
    show(enhance_ ? whole_enhanced_ : whole_differences_);
  } else {
    show(enhance_ ? enhanced_ : exact_);
  }
}

}  // namespace seqloop
