// SPDX-License-Identifier: MIT
#include "seqloop/detail/sideways_shift.hpp"

#include <algorithm>
#include <cstdlib>

#include "seqloop/detail/sketch.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

/// What is compared needs no sketch.
DescriptorForm without_sketch(DescriptorForm form) {
  form.scanned = false;
  return form;
}

/// How alike a frame and a place are: 1, the same; 0, as vectors at right angles.
double likeness(const DescriptorRows& frames, std::size_t frame, const DescriptorRows& places,
                std::size_t slot) {
  const double apart = places.difference(frames, frame, slot);
  // The share of a sketch's bits that differ is half of the difference.
  const bool sketched = places.form().arithmetic == Arithmetic::sketch;
  return 1.0 - (sketched ? squared_chord(apart / 2.0) : apart * apart) / 2.0;
}

}  // namespace

SidewaysShift::SidewaysShift(Arena& arena, const DescriptorForm& form, bool on)
    : frame_(arena, {"a moved frame", "its length", "its sketch"}, without_sketch(form),
             on ? 1 : 0),
      moved_(arena.take<float>("a moved descriptor", on ? form.size : 0)) {}

void SidewaysShift::stand_in(std::size_t columns) noexcept {
  columns_ = columns;
  most_ = moved_.empty() || columns < 2 ? 0 : static_cast<int>(columns) - 1;
}

std::size_t SidewaysShift::learn(const QueryHistory& queries, std::span<const float> descriptor,
                                 const PlaceMap& map, std::size_t row, double news) noexcept {
  if (most_ == 0) return 0;
  lost_ = 0;
  std::size_t computed = 0;
  const auto like = [&](const DescriptorRows& frames, std::size_t frame, std::size_t at) {
    ++computed;
    return likeness(frames, frame, map.rows(), map.order().slot(at));
  };
  const std::size_t newest = queries.row_of(queries.newest());
  const double here = like(queries.moved(), newest, row);
  const CandidateRun session = map.order().around(row);
  const auto best_beside = [&](const DescriptorRows& frames, std::size_t reach) {
    double best = -1.0;
    const std::size_t first = std::max(session.first + reach, row) - reach;
    for (std::size_t at = first; at < std::min(session.last, row + reach + 1); ++at) {
      if (at != row) best = std::max(best, like(frames, newest, at));
    }
    return best;
  };
  constexpr double clearly = 0.05;
  if (best_beside(queries.moved(), rows_beside) > here + clearly) return computed;
  constexpr double much = 0.1;
  const double unmoved = now_ == 0 ? -1.0 : best_beside(queries.rows(), rows_unmoved) - much;

  // To begin with, as if that much had been seen of which neither side is any better.
  constexpr double nothing_seen = 5.0;
  constexpr double memory = 40.0;
  seen_ = std::min(seen_ + news, memory);
  const double weight = news / (nothing_seen + seen_);
  const auto learn_side = [&](double& mean, int halves) {
    if (halves > most_ || halves < -most_) return;
    frame_.store(0, moved_by(descriptor, halves));
    double there = like(frame_, 0, row);
    if (std::abs(halves) < std::abs(now_)) there = std::max(there, unmoved);
    mean += weight * (there - here - mean);
  };
  learn_side(more_, now_ + 1);
  learn_side(less_, now_ - 1);
  go_on();
  return computed;
}

/// Moves by a half where that makes frames clearly more alike; back towards none, where they are no
/// less so.
void SidewaysShift::go_on() noexcept {
  constexpr double away = 0.01;
  constexpr double back = 0.0;
  const double least_more = now_ >= 0 ? away : back;
  const double least_less = now_ <= 0 ? away : back;
  const bool by_more = more_ > least_more && (more_ >= less_ || less_ <= least_less);
  if (!by_more && less_ <= least_less) return;
  now_ += by_more ? 1 : -1;
  // On the way back, what lies ahead is taken to be worse until it has been seen.
  const double unknown_more = now_ <= 0 ? -away : 0.0;
  const double unknown_less = now_ >= 0 ? -away : 0.0;
  const double before = by_more ? -more_ : -less_;
  more_ = by_more ? unknown_more : before;
  less_ = by_more ? before : unknown_less;
}

std::span<const float> SidewaysShift::moved_by(std::span<const float> descriptor,
                                               int halves) noexcept {
  if (halves == 0) return descriptor;
  const auto last = static_cast<std::ptrdiff_t>(columns_) - 1;
  const std::ptrdiff_t whole = halves >> 1;
  const std::ptrdiff_t beside = whole + (halves & 1);
  for (std::size_t first = 0; first < descriptor.size(); first += columns_) {
    const float* row = &descriptor[first];
    float* out = &moved_[first];
    for (std::ptrdiff_t column = 0; column <= last; ++column) {
      const float a = row[std::clamp<std::ptrdiff_t>(column + whole, 0, last)];
      const float b = row[std::clamp<std::ptrdiff_t>(column + beside, 0, last)];
      out[column] = 0.5F * (a + b);
    }
  }
  static_cast<void>(normalise(moved_));
  return moved_;
}

}  // namespace seqloop
