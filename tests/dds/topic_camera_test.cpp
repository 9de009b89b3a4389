// SPDX-License-Identifier: MIT
// What becomes of messages on the way from DDS to the loop. The publishers are Cyclone DDS's too;
// fast_end.cpp is one of another maker.
#include "seqloop/dds/topic_camera.hpp"

#include <dds/dds.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bags/bag_bytes.hpp"
#include "dds/entity.hpp"
#include "dds/idl/ros2.h"
#include "dds/topic_type.hpp"
#include "expect_setup_error.hpp"
#include "seqloop/dds/odometry_topic.hpp"
#include "seqloop/linux/steady_clock.hpp"

namespace seqloop::dds {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t start = 1'700'000'000 * second + 5;

/// A domain that no other test talks in, as ros.py takes it: this process locks it as long as it
/// lives. Higher ones have ports that the system gives to anybody.
std::uint32_t own_domain() {
  static const std::uint32_t own = [] {
    constexpr std::uint32_t domains = 98;
    const std::string name = std::filesystem::temp_directory_path() / "seqloop-test-domain-";
    for (std::uint32_t i = 0; i < domains; ++i) {
      const std::uint32_t domain = 1 + (static_cast<std::uint32_t>(getpid()) + i) % domains;
      const int lock =
          open((name + std::to_string(domain)).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
      if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0) return domain;
      if (lock >= 0) close(lock);
    }
    throw std::runtime_error("all domains are taken by other tests");
  }();
  return own;
}

/// On the loopback interface, in a domain of this process's own.
Network own_network() {
  return {own_domain(),
          network([](const char*) { return nullptr; }).configuration +
              ",<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\" "
              "multicast=\"true\"/></Interfaces></General></Domain></CycloneDDS>"};
}

/// The publishers' side: to DDS the same domain, but with sockets of its own, so that messages go
/// over the wire.
constexpr std::uint32_t further = 30;

std::string same_domain() {
  return own_network().configuration + ",<CycloneDDS><Domain><Discovery><ExternalDomainId>" +
         std::to_string(own_network().domain) +
         "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
}

char* text(const std::string& words) { return const_cast<char*>(words.c_str()); }

/// A publisher of pictures, as another participant.
class Camera {
 public:
  Camera(const std::string& topic, const TopicType& type, bool reliable)
      : participant_(dds_create_participant(own_network().domain + further, nullptr, nullptr),
                     topic),
        topic_(dds_create_topic(participant_.handle(), type.descriptor, wire_name(topic).c_str(),
                                nullptr, nullptr),
               topic),
        writer_(dds_create_writer(participant_.handle(), topic_.handle(),
                                  make_qos(type, reliable, 10).get(), nullptr),
                topic) {}

  void image(std::int64_t stamp_ns, std::uint32_t width, std::uint32_t height,
             const std::string& encoding, std::uint32_t step, std::vector<std::uint8_t> data) {
    const std::string frame = "camera";
    sensor_msgs_msg_dds__Image_ message{};
    message.header = {{static_cast<std::int32_t>(stamp_ns / second),
                       static_cast<std::uint32_t>(stamp_ns % second)},
                      text(frame)};
    message.height = height;
    message.width = width;
    message.encoding = text(encoding);
    message.step = step;
    message.data._buffer = data.data();
    message.data._length = message.data._maximum = static_cast<std::uint32_t>(data.size());
    write(&message);
  }

  void compressed(std::int64_t stamp_ns, std::vector<std::uint8_t> data) {
    const std::string words = "jpeg";
    sensor_msgs_msg_dds__CompressedImage_ message{};
    message.header = {{static_cast<std::int32_t>(stamp_ns / second), 0}, text(words)};
    message.format = text(words);
    message.data._buffer = data.data();
    message.data._length = message.data._maximum = static_cast<std::uint32_t>(data.size());
    write(&message);
  }

  void write(const void* message) { ASSERT_EQ(dds_write(writer_.handle(), message), 0); }

 private:
  Entity participant_;
  Entity topic_;
  Entity writer_;
};

class TopicCameraTest : public ::testing::Test {
 protected:
  TopicCameraTest() {
    std::printf("domain %u\n", own_network().domain);
    camera_ = std::make_unique<TopicCamera>(*participant_, "/camera", milliseconds(500), clock_);
  }

  Captured next() {
    Captured captured;
    while (captured.what == Capture::nothing) camera_->next(captured, never_);
    return captured;
  }

  /// Waits until the camera hears a publisher, so that none of its messages is missed.
  void until_heard() {
    const std::uint64_t before = camera_->counters().subscriptions;
    while (camera_->counters().subscriptions == before) {
      Captured captured = next();
      ASSERT_NE(captured.what, Capture::frame);
    }
    clock_.sleep_until(clock_.now() + milliseconds(200));  // and the publisher knows of it
  }

  /// The next that is no silence.
  Captured next_message() {
    Captured captured = next();
    for (int i = 0;
         i < 20 && captured.what != Capture::frame && captured.what != Capture::bad_frame; ++i) {
      captured = next();
    }
    return captured;
  }

  const TopicType& image_ = topic_type("sensor_msgs/msg/Image");
  const TopicType& compressed_ = topic_type("sensor_msgs/msg/CompressedImage");
  std::optional<Participant> participant_{std::in_place, own_network()};
  Entity others_{dds_create_domain(own_network().domain + further, same_domain().c_str()),
                 "others"};
  live::SteadyClock clock_;
  std::atomic<bool> never_{false};
  std::unique_ptr<TopicCamera> camera_;
};

TEST_F(TopicCameraTest, NobodyPublishes) {
  const Captured captured = next();
  EXPECT_EQ(captured.what, Capture::lost);
  EXPECT_TRUE(captured.fault.view().starts_with("nobody publishes /camera since "))
      << captured.fault.view();
}

TEST_F(TopicCameraTest, IsFoundAmongThousandsOfPublishers) {
  const Entity crowd(dds_create_participant(own_network().domain + further, nullptr, nullptr),
                     "crowd");
  const Entity topic(
      dds_create_topic(crowd.handle(), image_.descriptor, "rt/other", nullptr, nullptr), "other");
  constexpr int publishers = 2500;
  for (int i = 0; i < publishers; ++i) {
    ASSERT_GT(dds_create_writer(crowd.handle(), topic.handle(), nullptr, nullptr), 0);
  }
  Camera publisher("/camera", image_, true);
  std::optional<Offer> offer;
  for (int i = 0; i < 200 && !offer; ++i) {
    clock_.sleep_until(clock_.now() + milliseconds(50));
    offer = participant_->offer("/camera");
  }
  ASSERT_TRUE(offer);
  EXPECT_EQ(offer->type, image_.name);
  EXPECT_TRUE(offer->reliable);
}

TEST_F(TopicCameraTest, EveryEncodingAndSizeAsItWasSent) {
  struct Case {
    const char* encoding;
    RawFormat format;
    std::uint32_t bytes;
  };
  const std::array cases{
      Case{"mono8", RawFormat::gray8, 1}, Case{"rgb8", RawFormat::rgb8, 3},
      Case{"bgr8", RawFormat::bgr8, 3},   Case{"rgba8", RawFormat::rgba8, 4},
      Case{"bgra8", RawFormat::bgra8, 4}, Case{"mono16", RawFormat::gray16, 2},
      Case{"yuv422", RawFormat::uyvy, 2}, Case{"uyvy", RawFormat::uyvy, 2},
      Case{"yuyv", RawFormat::yuyv, 2},   Case{"yuv422_yuy2", RawFormat::yuyv, 2}};
  Camera publisher("/camera", image_, true);
  until_heard();
  std::uint32_t size = 2;
  std::int64_t stamp = start;
  for (const Case& one : cases) {
    SCOPED_TRACE(one.encoding);
    size += 98;  // from one picture to the next, in several packets at last
    std::vector<std::uint8_t> data(std::size_t{size} * size * one.bytes);
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i * 7 + size);
    publisher.image(stamp += second / 10, size, size, one.encoding, size * one.bytes, data);
    const Captured captured = next_message();
    ASSERT_EQ(captured.what, Capture::frame) << captured.fault.view();
    EXPECT_EQ(captured.picture.format, one.format);
    EXPECT_EQ(captured.picture.width, static_cast<int>(size));
    EXPECT_EQ(captured.picture.stride, std::size_t{size} * one.bytes);
    EXPECT_TRUE(std::ranges::equal(captured.picture.bytes, data));
    camera_->give_back(captured);
  }
  EXPECT_EQ(camera_->counters().frames, cases.size());
  EXPECT_EQ(camera_->start_ns(), start + second / 10);
}

TEST_F(TopicCameraTest, WhatIsHeldStaysAsItIsWhateverComes) {
  Camera publisher("/camera", image_, true);
  until_heard();
  std::vector<Captured> held;
  for (std::uint8_t i = 0; i < 20; ++i) {
    publisher.image(start + i * second, 100, 100, "mono8", 100,
                    std::vector<std::uint8_t>(10'000, i));
    held.push_back(next_message());
    ASSERT_EQ(held.back().what, Capture::frame);
    EXPECT_EQ(held.back().index, i);
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto bytes = held[k].picture.bytes;
      ASSERT_TRUE(std::ranges::all_of(bytes, [&](auto b) { return b == i + 1 - held.size() + k; }));
    }
    if (held.size() < CaptureDevice::most_out) continue;
    camera_->give_back(held.front());
    held.erase(held.begin());
  }
}

TEST_F(TopicCameraTest, WhatIsNoPictureIsABadFrame) {
  Camera publisher("/camera", image_, true);
  until_heard();
  publisher.image(start, 4, 2, "bayer_rggb8", 4, std::vector<std::uint8_t>(8));
  Captured captured = next_message();
  EXPECT_EQ(captured.what, Capture::bad_frame);
  EXPECT_TRUE(captured.fault.view().starts_with("pictures of the encoding 'bayer_rggb8'"));
  publisher.image(start + second, ~0U, ~0U, "mono8", 4, {});
  captured = next_message();
  EXPECT_EQ(captured.what, Capture::bad_frame);
  EXPECT_EQ(captured.fault.view(), "no picture is as large as it says");
  publisher.image(start + 2 * second, 4, 2, "mono8", 4, std::vector<std::uint8_t>(8));
  EXPECT_EQ(next_message().what, Capture::frame);
  EXPECT_EQ(camera_->counters().bad, 2U);
}

TEST_F(TopicCameraTest, WhatIsNotOfTheTypeIsCountedAndTheNextPictureComes) {
  Camera publisher("/camera", image_, true);
  until_heard();
  publisher.image(start, 4, 2, "mono8", 4, std::vector<std::uint8_t>(8));
  EXPECT_EQ(next_message().what, Capture::frame);
  // The same name on the wire, another content: numbers where the picture has its texts' sizes.
  dds_topic_descriptor_t other = geometry_msgs_msg_dds__PoseWithCovariance__desc;
  other.m_typename = image_.descriptor->m_typename;
  Camera liar("/camera", {image_.name, image_.hash, &other}, true);
  clock_.sleep_until(clock_.now() + milliseconds(300));
  geometry_msgs_msg_dds__PoseWithCovariance_ lie{};
  std::memset(static_cast<void*>(&lie), 0xff, sizeof lie);
  for (int i = 0; i < 3; ++i) liar.write(&lie);
  for (int i = 0; i < 3; ++i) {
    const Captured captured = next_message();
    ASSERT_EQ(captured.what, Capture::bad_frame);
    EXPECT_EQ(captured.fault.view(), "a message on /camera is not of its type, or too large");
  }
  publisher.image(start + second, 4, 2, "mono8", 4, std::vector<std::uint8_t>(8));
  const Captured captured = next_message();
  EXPECT_EQ(captured.what, Capture::frame);
  EXPECT_EQ(captured.index, 4U);
  EXPECT_EQ(captured.time_s, 1.0);
}

TEST_F(TopicCameraTest, WhatIsTooLargeIsCounted) {
  camera_.reset();
  participant_.reset();
  participant_.emplace(Network{
      own_network().domain,
      own_network().configuration +
          ",<CycloneDDS><Domain><Internal><MaxSampleSize>5000B</MaxSampleSize></Internal></Domain>"
          "</CycloneDDS>"});
  camera_ = std::make_unique<TopicCamera>(*participant_, "/camera", milliseconds(500), clock_);
  Camera publisher("/camera", image_, true);
  until_heard();
  publisher.image(start, 100, 100, "mono8", 100, std::vector<std::uint8_t>(10'000));
  publisher.image(start, 10, 10, "mono8", 10, std::vector<std::uint8_t>(100));
  std::vector<Capture> came{next_message().what, next_message().what};
  std::ranges::sort(came);
  EXPECT_EQ(came, (std::vector{Capture::frame, Capture::bad_frame}));
}

TEST_F(TopicCameraTest, APublisherThatComesBackIsHeardAgainWhateverItOffers) {
  {
    Camera publisher("/camera", image_, false);
    until_heard();
    publisher.image(start, 4, 2, "mono8", 4, std::vector<std::uint8_t>(8));
    EXPECT_EQ(next_message().what, Capture::frame);
  }
  Captured captured = next();
  EXPECT_EQ(captured.what, Capture::lost) << captured.fault.view();
  Camera publisher("/camera", compressed_, true);
  until_heard();
  publisher.compressed(start + second, {0xff, 0xd8, 0xff, 0xe0});
  captured = next_message();
  EXPECT_EQ(captured.what, Capture::frame);
  EXPECT_EQ(captured.picture.format, RawFormat::mjpg);
  EXPECT_EQ(camera_->counters().subscriptions, 2U);
}

TEST_F(TopicCameraTest, ATopicOfSomethingElseIsNamed) {
  const TopicType& odometry = topic_type("nav_msgs/msg/Odometry");
  Camera publisher("/camera", odometry, true);
  clock_.sleep_until(clock_.now() + milliseconds(300));
  const Captured captured = next();
  EXPECT_EQ(captured.what, Capture::lost);
  EXPECT_TRUE(captured.fault.view().starts_with("/camera is nav_msgs/msg/Odometry, not "))
      << captured.fault.view();
}

TEST_F(TopicCameraTest, OdometryIsKeptWhateverItsStampsDo) {
  OdometryTopic odometry(*participant_, "/odom", 8);
  Camera publisher("/odom", topic_type("nav_msgs/msg/Odometry"), true);
  const std::string frame = "odom";
  nav_msgs_msg_dds__Odometry_ message{};
  message.header.frame_id = message.child_frame_id = text(frame);
  const auto says = [&](std::int32_t seconds) {
    message.header.stamp.sec = seconds;
    publisher.write(&message);
  };
  const auto kept = [&](std::size_t least) {
    std::vector<std::int64_t> seconds;
    for (int i = 0; i < 100 && seconds.size() < least; ++i) {
      clock_.sleep_until(clock_.now() + milliseconds(50));
      seconds.clear();
      for (const ros::OdometryPose& pose : odometry.poses()) {
        seconds.push_back(pose.stamp_ns / second);
      }
    }
    return seconds;
  };
  for (int i = 0; i < 100 && odometry.poses().empty(); ++i) {  // until it is heard
    says(99);
    clock_.sleep_until(clock_.now() + milliseconds(50));
  }
  for (const int seconds : {100, 4000, 101, 50, 51, 51}) says(seconds);
  EXPECT_EQ(kept(6), (std::vector<std::int64_t>{99, 100, 4000, 101, 50, 51}))
      << "the last is early";
  // Memory is bounded whatever comes.
  for (int i = 0; i < 200; ++i) says(40 - i % 40);
  clock_.sleep_until(clock_.now() + milliseconds(500));
  EXPECT_LE(odometry.poses().size(), 8U);
}

TEST_F(TopicCameraTest, StopsWithinATimeStep) {
  never_ = true;
  Captured captured;
  camera_->next(captured, never_);
  EXPECT_EQ(captured.what, Capture::nothing);
}

TEST(Participant, OneAtATimeAndWhatIsWrongIsTold) {
  const std::string said = test::setup_error([] {
    Participant(Network{1, "<CycloneDDS><Domain><NoSuch>1</NoSuch></Domain></CycloneDDS>"});
  });
  EXPECT_TRUE(said.starts_with("ROS 2: opening domain 1: ")) << said;
  EXPECT_NE(said.find("NoSuch"), std::string::npos) << said;
  const Participant one(own_network());
  EXPECT_TRUE(test::setup_error([] {
                const Participant two(own_network());
              }).starts_with("ROS 2: opening domain "));
}

}  // namespace
}  // namespace seqloop::dds
