// SPDX-License-Identifier: MIT
// Without DDS, no run gets this far: join_ros throws.
#include "program/watch/ros_answers.hpp"

namespace seqloop::program {

class RosAnswers::Impl {};

RosAnswers::RosAnswers(std::shared_ptr<dds::Participant> /*participant*/, StampAt /*stamp_ns*/,
                       bool /*own_places*/, std::unique_ptr<PlacePictures> /*pictures*/) {}
RosAnswers::~RosAnswers() = default;
void RosAnswers::add_place(const Image& /*image*/, std::uint64_t /*number*/) {}
void RosAnswers::keep_in(const LastingMap& /*map*/) {}
void RosAnswers::publish(const ProcessedFrame& /*processed*/, const LoopState& /*state*/,
                         const RunSummary& /*summary*/, const MapState& /*map*/,
                         Nanoseconds /*moment*/) noexcept {}
void RosAnswers::publish(std::span<const Answer> /*answers*/) noexcept {}
void RosAnswers::publish(std::span<const OtherLoop> /*loops*/) noexcept {}
std::uint64_t RosAnswers::end() { return 0; }

}  // namespace seqloop::program
