// SPDX-License-Identifier: MIT
#include "program/fleet/through_own.hpp"

#include <algorithm>

#include "program/fleet/place_number.hpp"

namespace seqloop::program {
namespace {

/// Frames back from the newest that an answer may be about.
std::size_t reach(const MatcherConfig& config) {
  return static_cast<std::size_t>(config.patience) + config.sequence_length + 2;
}

bool accepted(const std::optional<Answer>& answer) {
  return answer && answer->gate == Gate::match && answer->match;
}

}  // namespace

std::vector<BufferSize> ThroughOwn::plan(const Capacity& own) {
  return {{"own places that are theirs", own.places * sizeof(Known)}};
}

ThroughOwn::ThroughOwn(const MatcherConfig& config, const PlaceMap& own)
    : own_(&own),
      decides_(config.decision == Decision::probability),
      grows_(config.use == Use::close_loops),
      pending_(reach(config)),
      known_(own.capacity()) {
  answers_.reserve(2 * pending_.size());
}

std::span<const Answer> ThroughOwn::take(std::span<const Answer> own,
                                         std::span<const Answer> others) noexcept {
  answers_.clear();
  // Without probabilities nothing is linked.
  if (!decides_) return others;
  for (const Answer& answer : own) {
    Pending& frame = pending(answer.frame);
    frame.own = answer;
    if (frame.others) take_both(frame);
  }
  for (const Answer& answer : others) {
    Pending& frame = pending(answer.frame);
    frame.others = answer;
    if (accepted(frame.others)) {
      if (grows_) learn(row_of_frame(answer.frame), answer);
      tell(frame);
    }
    if (frame.own) take_both(frame);
  }
  return answers_;
}

std::span<const Answer> ThroughOwn::finish(std::span<const Answer> own,
                                           std::span<const Answer> others) noexcept {
  const std::span<const Answer> last = take(own, others);
  if (!decides_) return last;
  for (Pending& frame : pending_) {
    if (frame.others) tell(frame);
  }
  return answers_;
}

ThroughOwn::Pending& ThroughOwn::pending(std::uint64_t frame) noexcept {
  Pending& its = pending_[static_cast<std::size_t>(frame % pending_.size())];
  if (its.frame == frame) return its;
  if (its.others) tell(its);
  its = {frame, std::nullopt, std::nullopt, false};
  return its;
}

void ThroughOwn::take_both(Pending& frame) noexcept {
  if (accepted(frame.own)) {
    const auto row = own_->order().row_of_number(frame.own->match->place);
    if (accepted(frame.others)) {
      learn(row, *frame.others);
    } else if (const std::optional<Known> place = known(row)) {
      Answer& answer = *frame.others;
      answer.gate = Gate::match;
      answer.probability = std::min(frame.own->probability, place->probability);
      answer.match = frame.own->match;
      answer.match->place = answer.match->head = place->other;
      answer.match->runner_up.reset();
    }
  }
  tell(frame);
}

void ThroughOwn::tell(Pending& frame) noexcept {
  if (frame.told) return;
  frame.told = true;
  answers_.push_back(*frame.others);
}

/// @param row of the own map that the place of others is
void ThroughOwn::learn(std::optional<std::size_t> row, const Answer& others) noexcept {
  if (!row) return;
  const PlaceOrder& order = own_->order();
  const Known place{order.number(*row), others.match->place, others.probability};
  known_[order.slot(*row)] = place;
  const auto first = first_visit(*row);
  if (!first || *first == *row) return;
  known_[order.slot(*first)] = {order.number(*first), place.other, place.probability};
}

/// @return what the nearest row that is known says; where that lies some rows off, so does the
///   other robot's frame
std::optional<ThroughOwn::Known> ThroughOwn::known(std::optional<std::size_t> row) const noexcept {
  if (!row) return std::nullopt;
  const PlaceOrder& order = own_->order();
  const auto near = [&](std::size_t middle) -> std::optional<Known> {
    const CandidateRun session = order.around(middle);
    for (std::size_t by = 0; by <= PlaceMap::beside; ++by) {
      for (const std::size_t at : {middle - by, middle + by}) {
        // Below 0, too: then it is a very large number.
        if (at < session.first || at >= session.last) continue;
        Known place = known_[order.slot(at)];
        if (place.number != order.number(at)) continue;
        const std::uint64_t frame = frame_of(place.other);
        const std::uint64_t there =
            at > middle ? frame - std::min<std::uint64_t>(frame, by) : frame + by;
        place.other = place_number(session_of(place.other), there);
        return place;
      }
    }
    return std::nullopt;
  };
  if (const std::optional<Known> place = near(*row)) return place;
  const auto first = first_visit(*row);
  return first && *first != *row ? near(*first) : std::nullopt;
}

/// The row that a frame of the drive has become.
std::optional<std::size_t> ThroughOwn::row_of_frame(std::uint64_t frame) const noexcept {
  const PlaceOrder& order = own_->order();
  const std::size_t row = order.row_of_frame(frame);
  if (row == order.size() || order.frame(row) != frame) return std::nullopt;
  return row;
}

std::optional<std::size_t> ThroughOwn::first_visit(std::size_t row) const noexcept {
  return own_->order().row_of_number(own_->first_visit(row));
}

}  // namespace seqloop::program
