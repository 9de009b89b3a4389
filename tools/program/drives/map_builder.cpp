// SPDX-License-Identifier: MIT
#include "program/drives/map_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "program/process/interruption.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/pipeline.hpp"
#include "seqloop/visit_finder.hpp"

namespace seqloop::program {
namespace {

// A second or so: whoever has a larger map keeps it in a file, where its visits are kept, too.
constexpr std::size_t most_looked_through = 20'000;

}  // namespace

std::size_t descriptor_size(const FrameSource& drive, const Describer* describer) {
  const auto* described = dynamic_cast<const files::DescriptorSource*>(&drive);
  return described != nullptr ? described->size() : describer->size();
}

Mapped fill_map(PlaceMap& map, FrameSource& drive, Describer* describer,
                const MatcherConfig& config, Progress& progress,
                const std::function<void(const Frame&)>& look) {
  // Where nothing is known of descriptors, the drive is learnt as a whole before its first place is
  // standardised.
  const bool learns = config.standardisation.on && map.statistics().frames() == 0;
  std::vector<float> buffer(map.descriptor_size());
  std::deque<std::vector<float>> described{std::vector<float>(map.descriptor_size(), 0.0F)};
  std::vector<std::span<const float>> learnt;
  std::span<const float> last = described.front();
  std::size_t places = 0;
  std::size_t readable = 0;
  std::size_t blank_frames = 0;
  std::optional<VisitFinder> visits;
  if (VisitFinder::is_needed(config)) {
    const std::uint64_t frames = drive.frame_count().value_or(map.capacity());
    visits.emplace(
        config, map,
        static_cast<std::size_t>(std::clamp<std::uint64_t>(frames, 1, most_looked_through)));
  }
  Frame frame;
  for (Grab grab = drive.grab(frame); grab != Grab::end; grab = drive.grab(frame)) {
    stop_if_interrupted();
    const auto [descriptor, fault, _] = describe(grab, frame, describer, buffer);
    if (descriptor.empty()) {
      progress.tell_fault(fmt::format("reference frame {}", frame.index), frame.index, fault);
    } else {
      ++readable;
      if (look) look(frame);
      const bool is_blank = blank(config.difference, descriptor);
      if (is_blank) ++blank_frames;
      const bool left_out = config.blank_is_unreadable && is_blank;
      const bool stays = descriptor.data() == frame.descriptor.data();
      if (!left_out && stays) last = descriptor;
      if (!left_out && !stays) {
        if (learns) described.emplace_back(map.descriptor_size());
        std::ranges::copy(descriptor, described.back().begin());
        last = described.back();
      }
    }
    if (places++ == map.capacity()) {
      throw SetupError({"max-places",
                        fmt::format("the reference has more frames than the map has room for, {}",
                                    map.capacity()),
                        "raise --max-places"});
    }
    if (visits) visits->take(last);
    if (learns) {
      learnt.push_back(last);
    } else {
      static_cast<void>(map.add(last));
    }
    progress.step();
  }
  progress.done();
  if (readable == 0) throw SetupError(Fault{"reference", "none of its frames can be read"});
  for (const std::span<const float> place : learnt) static_cast<void>(map.learn(place));
  for (const std::span<const float> place : learnt) static_cast<void>(map.add(place));
  if (visits) visits->link(map);
  if (visits && places > most_looked_through) {
    progress.tell(fmt::format(
        "places after the first {} of the reference are not looked through for other visits of one "
        "place: if it has any, localise in a map that was made of it once, by 'seqloop run "
        "--source REFERENCE --map FILE'",
        most_looked_through));
  }
  return {places, blank_frames};
}

}  // namespace seqloop::program
