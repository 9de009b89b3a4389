// SPDX-License-Identifier: MIT
#include "program/drives/source_numbers.hpp"

namespace seqloop::program {
namespace {

/// A number that is an index.
std::size_t at(std::uint64_t number) noexcept { return static_cast<std::size_t>(number); }

/// Frames back from the newest that an answer may be about, those that wait and as many more as may
/// be skipped at once, or that may become places: those that were held back.
std::size_t reach(const MatcherConfig& config) {
  return config.patience + Keyframes::most_held_back(config.sequence_length) + 2;
}

}  // namespace

SourceNumbers::SourceNumbers(const MatcherConfig& config, const PlaceMap* map)
    : map_(map), recent_(reach(config)), places_(map == nullptr ? 0 : map->capacity()) {
  answers_.reserve(reach(config));
}

void SourceNumbers::rename(ProcessedFrame& processed) noexcept {
  FrameReport& report = processed.report;
  if (report.gate == Gate::no_frame) return;
  note(report.newest, processed.frame.index);
  report.newest = processed.frame.index;
  if (report.frame) report.frame = frame(*report.frame);
  rename(report.match);
  if (report.now && map_ != nullptr) report.now->place = place(report.now->place);
  report.answers = rename(report.answers);
}

std::span<const Answer> SourceNumbers::rename(std::span<const Answer> answers) noexcept {
  answers_.assign(answers.begin(), answers.end());
  for (Answer& answer : answers_) {
    answer.frame = frame(answer.frame);
    rename(answer.match);
  }
  return answers_;
}

/// What the detector has counted since the last frame came just before this one. Frames before
/// that may have become places since.
void SourceNumbers::note(std::uint64_t newest, std::uint64_t index) noexcept {
  const std::uint64_t first = counted_;
  for (; counted_ <= newest; ++counted_) {
    recent_[at(counted_ % recent_.size())] = index - (newest - counted_);
  }
  if (map_ == nullptr) return;
  const PlaceOrder& order = map_->order();
  for (std::size_t row = order.size(); row > 0 && order.number(row - 1) >= next_place_; --row) {
    const std::uint64_t number = order.number(row - 1);
    places_[order.slot(row - 1)] = number < first ? frame(number) : index - (newest - number);
  }
  next_place_ = order.next_number();
}

std::uint64_t SourceNumbers::frame(std::uint64_t counted) const noexcept {
  return recent_[at(counted % recent_.size())];
}

std::uint64_t SourceNumbers::place(std::uint64_t number) const noexcept {
  // The first row of this number or a higher one.
  std::size_t first = 0;
  std::size_t end = map_->size();
  while (first < end) {
    const std::size_t middle = first + (end - first) / 2;
    if (map_->order().number(middle) < number) {
      first = middle + 1;
    } else {
      end = middle;
    }
  }
  return first == map_->size() ? number : places_[map_->order().slot(first)];
}

void SourceNumbers::rename(std::optional<Match>& match) const noexcept {
  if (!match || map_ == nullptr) return;
  match->place = place(match->place);
  match->head = place(match->head);
  if (match->runner_up) match->runner_up = place(*match->runner_up);
}

}  // namespace seqloop::program
