// SPDX-License-Identifier: MIT
#include "core/shown_drive.hpp"

#include <algorithm>

namespace seqloop::oracle {

ShownDrive::ShownDrive(const MatcherConfig& config, const PlaceMap& map, const Vectors& reference)
    : config_(config),
      map_(map),
      lines_(lines(config)),
      reference_(reference.begin(), reference.end()) {}

void ShownDrive::step(const std::vector<float>& descriptor) {
  if (!descriptor.empty()) {
    frames_.emplace_back(descriptor);
  } else if (frames_.empty()) {
    frames_.emplace_back(std::vector<float>(map_.descriptor_size(), 0.0F));
  } else {
    frames_.push_back(Forms(frames_.back()));
  }
}

void ShownDrive::skip(std::uint64_t frames) {
  if (frames_.empty()) return;
  if (frames > config_.sequence_length) {
    began_ = static_cast<std::int64_t>(frames_.size());
    return;
  }
  for (std::uint64_t frame = 0; frame < frames; ++frame) step({});
}

bool ShownDrive::whole() const {
  return static_cast<std::int64_t>(frames_.size()) - began_ >
         static_cast<std::int64_t>(config_.sequence_length);
}

std::int64_t ShownDrive::rows() const {
  const auto places = static_cast<std::int64_t>(map_.size());
  if (config_.use == Use::localise) return places;
  const auto ds = static_cast<std::int64_t>(config_.sequence_length);
  const auto newest = static_cast<std::int64_t>(frames_.size()) - 1;
  const std::int64_t old = newest - (ds - ds / 2) - static_cast<std::int64_t>(config_.exclude);
  std::int64_t rows = 0;
  while (rows < places && static_cast<std::int64_t>(number(rows)) < old) ++rows;
  return rows;
}

std::optional<ShownDrive::Scored> ShownDrive::score(std::int64_t row) const {
  const auto ds = static_cast<std::int64_t>(config_.sequence_length);
  const auto oldest = static_cast<std::int64_t>(frames_.size()) - 1 - ds;
  const std::int64_t last = rows();
  const double scale = 1.0 / (unit(config_) * static_cast<double>(ds + 1));
  std::optional<Scored> best;
  for (const Line& line : lines_) {
    const std::int64_t head = row + line.rows.back();
    if (row + line.rows.front() < 0 || head >= last) continue;
    double sum = 0.0;
    for (std::int64_t i = 0; i <= ds; ++i) {
      sum += difference(config_, place(row + line.rows[static_cast<std::size_t>(i)]),
                        frames_[static_cast<std::size_t>(oldest + i)]);
    }
    if (!best || sum * scale < best->score) best = Scored{sum * scale, head};
  }
  return best;
}

std::uint64_t ShownDrive::number(std::int64_t row) const {
  return map_.order().number(static_cast<std::size_t>(row));
}

std::optional<std::int64_t> ShownDrive::row_of(std::uint64_t number) const {
  for (std::int64_t row = 0; row < static_cast<std::int64_t>(map_.size()); ++row) {
    if (this->number(row) == number) return row;
  }
  return std::nullopt;
}

const Forms& ShownDrive::place(std::int64_t row) const {
  return config_.use == Use::localise ? reference_[static_cast<std::size_t>(row)]
                                      : frames_[static_cast<std::size_t>(number(row))];
}

}  // namespace seqloop::oracle
