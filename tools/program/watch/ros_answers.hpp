// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "program/map/lasting_map.hpp"
#include "program/map/place_pictures.hpp"
#include "program/run/frame_times.hpp"
#include "program/watch/watch.hpp"

namespace seqloop::dds {
class Participant;
}

namespace seqloop::program {

/// Tells ROS 2 what a run finds, while it goes on: the topics of `dds::Publisher`. A thread of the
/// lowest priority sends; the loop hands it snapshots and never waits. What finds no room on the
/// way, or is too much for the subscribers, is dropped and counted.
class RosAnswers {
 public:
  /// @param stamp_ns asked by the thread that sends, once a frame has come
  /// @param own_places whether places are frames of the drive itself
  /// @param pictures of a map's places; null: there are those that `add_place` brings
  /// Throws SetupError.
  RosAnswers(std::shared_ptr<dds::Participant> participant, StampAt stamp_ns, bool own_places,
             std::unique_ptr<PlacePictures> pictures);
  RosAnswers(const RosAnswers&) = delete;
  RosAnswers& operator=(const RosAnswers&) = delete;
  RosAnswers(RosAnswers&&) = delete;
  RosAnswers& operator=(RosAnswers&&) = delete;
  ~RosAnswers();

  /// A picture of a place, before the first frame. Allocates: yes.
  void add_place(const Image& image, std::uint64_t number);

  /// The map that lasts, once the drive has begun and before its first frame: of which sessions
  /// places are.
  void keep_in(const LastingMap& map);

  /// As `Watch::publish`.
  void publish(const ProcessedFrame& processed, const LoopState& state, const RunSummary& summary,
               const MapState& map, Nanoseconds moment) noexcept;
  void publish(std::span<const Answer> answers) noexcept;
  void publish(std::span<const OtherLoop> loops) noexcept;

  /// Sends what waits, and gives subscribers a second to get it. Nothing is published afterwards.
  /// @return messages that were dropped
  std::uint64_t end();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::program
