// SPDX-License-Identifier: MIT
#include "program/drives/describe_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "program/drives/drives.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::program {
namespace {

// Rows that stand for one gap: longer than any window, so that none reaches across it.
constexpr std::uint64_t most_missing = 1'000;

}  // namespace

DescribedCount describe_drive(const std::string& name, FrameSource& source, Describer& describer,
                              const DescriptorSink& out, Progress& progress,
                              const DescribeUntil& until) {
  DescribedCount count;
  std::vector<float> descriptor(describer.size());
  const std::vector<float> nothing(describer.size(), 0.0F);
  const auto whole = [&] { return until.rows > 0 && count.rows >= until.rows; };
  const auto append = [&](std::span<const float> row) {
    out(row);
    ++count.rows;
  };
  bool silent = false;
  Frame frame;
  while (!whole()) {
    const Grab grab = source.grab(frame);
    if (grab == Grab::end) break;
    if (!until.interrupted) stop_if_interrupted();
    const bool was_silent = std::exchange(silent, grab == Grab::silent);
    if (silent) {
      if (!was_silent) progress.tell(fmt::format("{}: {}", name, frame.fault));
      continue;
    }
    const std::uint64_t gap = frame.lost + frame.dropped;
    if (was_silent || gap > most_missing) {
      progress.tell(fmt::format("{}: frames come again, after {} that are missing", name, gap));
    }
    for (std::uint64_t row = 0; row < std::min(gap, most_missing) && !whole(); ++row) {
      append(nothing);
      ++count.missing;
    }
    if (whole()) break;
    const DescribedFrame described = describe(grab, frame, &describer, descriptor);
    if (described.descriptor.empty()) {
      std::ranges::fill(descriptor, 0.0F);
      ++count.unreadable;
      progress.tell_fault(fmt::format("{}: frame {}", name, frame.index), frame.index,
                          described.fault);
    } else if (described.blank) {
      ++count.blank;
    }
    append(descriptor);
    progress.step();
  }
  progress.done();
  tell_notes(name, source);
  if (count.rows == count.unreadable + count.missing) {
    throw SetupError({name, "none of its frames can be read"});
  }
  return count;
}

}  // namespace seqloop::program
