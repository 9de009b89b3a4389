// SPDX-License-Identifier: MIT
#include "program/drives/live_topic.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "program/drives/file_decoder.hpp"
#include "program/drives/live_camera.hpp"
#include "program/drives/warm_up.hpp"
#include "seqloop/dds/odometry_topic.hpp"
#include "seqloop/dds/participant.hpp"
#include "seqloop/dds/topic_camera.hpp"

namespace seqloop::program {
namespace {

/// A camera of a topic, and the participant that it needs.
class HeldCamera : public CaptureDevice {
 public:
  HeldCamera(std::shared_ptr<dds::Participant> participant, const std::string& topic,
             Nanoseconds timeout, Clock& clock)
      : participant_(std::move(participant)), camera_(*participant_, topic, timeout, clock) {}

  void next(Captured& captured, const std::atomic<bool>& stop) noexcept override {
    camera_.next(captured, stop);
  }
  void give_back(const Captured& captured) noexcept override { camera_.give_back(captured); }

  [[nodiscard]] std::int64_t start_ns() const noexcept { return camera_.start_ns(); }
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t time_ns) const noexcept {
    return camera_.stamp_ns(time_ns);
  }

 private:
  std::shared_ptr<dds::Participant> participant_;
  dds::TopicCamera camera_;
};

}  // namespace

std::shared_ptr<dds::Participant> join_ros(const RealTimeSettings& real_time) {
  return std::make_shared<dds::Participant>(dds::network(
      [](const char* name) { return std::getenv(name); }, real_time.capture_thread().priority));
}

LiveTopic open_topic(const std::filesystem::path& path,
                     const std::shared_ptr<dds::Participant>& participant, double fps,
                     Describer& describer, const RealTimeSettings& real_time, Clock& clock) {
  constexpr double frames_to_wait = 3.0;
  constexpr int usual_width = 640;
  constexpr int usual_height = 480;
  const Nanoseconds timeout = std::max<Nanoseconds>(
      std::chrono::seconds(1),
      std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double>(frames_to_wait / fps)));
  auto camera = std::make_unique<HeldCamera>(participant, topic_of(path), timeout, clock);
  auto decoder = std::make_unique<FileDecoder>();
  for (const RawFormat format : {RawFormat::mjpg, RawFormat::rgb8}) {
    warm_up(*decoder, describer, format, usual_width, usual_height);
  }
  live::LiveSettings settings = live_settings(real_time);
  settings.hang_timeout += timeout;
  settings.from_first_taken = true;
  const HeldCamera* const held = camera.get();
  LiveTopic topic;
  topic.source = std::make_unique<live::LiveSource>(std::move(camera), std::move(decoder), clock,
                                                    std::move(settings));
  topic.start_ns = [held, source = topic.source.get()] {
    return held->start_ns() + std::llround(source->first_time_s() * 1e9);
  };
  topic.stamp_ns = [held, source = topic.source.get()](double time_s) {
    return held->stamp_ns(std::llround(source->first_time_s() * 1e9) + std::llround(time_s * 1e9));
  };
  return topic;
}

std::function<std::vector<ros::OdometryPose>()> open_odometry(
    const std::string& topic, const std::shared_ptr<dds::Participant>& participant) {
  // Functions are copied, a listener is not. The participant goes last.
  struct Held {
    std::shared_ptr<dds::Participant> participant;
    dds::OdometryTopic topic;
  };
  const auto held = std::shared_ptr<Held>(new Held{participant, {*participant, topic}});
  return [held] { return held->topic.poses(); };
}

}  // namespace seqloop::program
