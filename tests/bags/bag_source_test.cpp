// SPDX-License-Identifier: MIT
#include "seqloop/bags/bag_source.hpp"

#include <optional>
#include <vector>

#include "bags/bag_bytes.hpp"
#include "bags/bag_folder.hpp"
#include "expect_setup_error.hpp"
#include "gtest/gtest.h"
#include "temporary_folder.hpp"

namespace seqloop::bags {
namespace {

using test::McapBytes;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t start = 1'700'000'000 * second;
const std::string image = "sensor_msgs/msg/Image";

/// Hands grey pictures on, and notes what it was given.
class Decoder : public PictureDecoder {
 public:
  std::string_view decode(const RawPicture& raw, Image& picture) noexcept override {
    if (raw.bytes.size() < 4) return "too few bytes";
    picture = {raw.bytes.data(), raw.width, raw.height, raw.stride, PixelFormat::gray8};
    return {};
  }
};

test::ByteVector picture(std::int64_t stamp, std::uint8_t gray, std::size_t bytes = 4) {
  return test::image_message(stamp, 2, 2, "mono8", 2, test::ByteVector(bytes, gray));
}

std::string written(const test::TemporaryFolder& folder, const McapBytes& file,
                    const std::string& name = "b.mcap") {
  return folder.write(name, std::string(file.bytes.begin(), file.bytes.end())).string();
}

McapBytes camera(std::initializer_list<test::ByteVector> messages, std::uint64_t recorded = 5) {
  McapBytes file;
  file.start().schema(1, image).channel(1, 1, "/camera");
  for (const auto& message : messages) file.message(1, recorded++ * second, message);
  return file.finish();
}

std::unique_ptr<BagSource> opened(const std::string& path, const std::string& topic = "") {
  return std::make_unique<BagSource>(path, topic, std::make_unique<Decoder>());
}

std::string refusal(const std::string& path, const std::string& topic = "") {
  return test::setup_error([&] { static_cast<void>(opened(path, topic)); });
}

TEST(BagSource, PicturesAndTheirStamps) {
  const test::TemporaryFolder folder;
  const auto source =
      opened(written(folder, camera({picture(start, 10), picture(start + second / 2, 20),
                                     picture(start + 1, 30, 3), picture(start + 2 * second, 40)})));
  EXPECT_EQ(source->frame_count(), std::optional<std::uint64_t>(4));
  EXPECT_EQ(source->start_ns(), start);
  Frame frame;
  ASSERT_EQ(source->grab(frame), Grab::frame);
  EXPECT_EQ(frame.index, 0U);
  EXPECT_EQ(frame.time_s, 0.0);
  EXPECT_EQ(frame.image.data[0], 10);
  ASSERT_EQ(source->grab(frame), Grab::frame);
  EXPECT_EQ(frame.time_s, 0.5);
  ASSERT_EQ(source->grab(frame), Grab::unreadable);
  EXPECT_EQ(frame.index, 2U);
  EXPECT_EQ(frame.time_s, 1.5) << "time does not go back, but on, as it does in the recording";
  EXPECT_EQ(frame.fault, "too few bytes");
  ASSERT_EQ(source->grab(frame), Grab::frame);
  EXPECT_EQ(frame.time_s, 2.0);
  EXPECT_EQ(source->grab(frame), Grab::end);
  EXPECT_EQ(source->notes().back(),
            "1 picture without a later stamp than the one before: between them the times are those "
            "of the recording");
}

constexpr std::int64_t none = -1;     // stamps of pictures without one
constexpr std::int64_t cut_off = -2;  // and of such that cannot be read

TEST(BagSource, ClocksThatAreSetBackStandStillOrBelongToAnotherPicture) {
  const test::TemporaryFolder folder;
  // Milliseconds, of the recording the times between.
  const auto times = [&folder](const std::vector<std::int64_t>& stamps,
                               std::vector<std::uint64_t> between) {
    between.resize(stamps.size(), 100);
    McapBytes file;
    file.start().schema(1, image).channel(1, 1, "/camera");
    std::uint64_t recorded = 5 * second;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      recorded += between[i] * 1'000'000;
      file.message(1, recorded,
                   stamps[i] == none      ? picture(0, 1)
                   : stamps[i] == cut_off ? test::ByteVector(1)
                                          : picture(start + stamps[i] * 1'000'000, 1));
    }
    const auto source = opened(written(folder, file.finish()));
    std::vector<double> found;
    for (Frame frame; source->grab(frame) != Grab::end;) found.push_back(frame.time_s);
    return found;
  };
  const auto expect = [&times](const std::vector<std::int64_t>& stamps_ms,
                               const std::vector<double>& seconds,
                               const std::vector<std::uint64_t>& between = {}) {
    const std::vector<double> found = times(stamps_ms, between);
    ASSERT_EQ(found.size(), seconds.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], seconds[i], 1e-6) << i;
  };
  expect({0, 100, 200, -999'700, -999'600}, {0, .1, .2, .3, .4});  // set back, to stay
  expect({0, 100, 200, 150, 250, 350}, {0, .1, .2, .3, .4, .5});   // by little
  expect({0, 100, 300, 200, 400, 500}, {0, .1, .3, .4, .6, .7});   // two that changed places
  expect({0, 100, 300, 200, 900}, {0, .1, .3, .4, .9});            // and the clock is right again
  expect({0, 0, 0, 0}, {0, .1, .2, .3});
  // A picture without a stamp, or that cannot be read, says nothing of the clock; nor does a stamp
  // that fits no other.
  const std::vector<std::uint64_t> hiccup{100, 100, 100, 300, 0, 0, 100};
  expect({0, 100, 200, none, 400, 500, 600}, {0, .1, .2, .5, .5, .5, .6}, hiccup);
  expect({0, 100, 200, cut_off, 400, 500, 600}, {0, .1, .2, .5, .5, .5, .6}, hiccup);
  expect({0, 100, 200, -999'700, 300, 400}, {0, .1, .2, .45, .46, .56}, {100, 100, 100, 250, 10});
  expect({cut_off, 0, 100, 200}, {0, 0, .1, .2});
}

TEST(BagSource, WithoutStampsTheTimesOfTheRecording) {
  const test::TemporaryFolder folder;
  const auto source = opened(written(folder, camera({picture(0, 1), picture(0, 2)})));
  Frame frame;
  ASSERT_EQ(source->grab(frame), Grab::frame);
  ASSERT_EQ(source->grab(frame), Grab::frame);
  EXPECT_EQ(frame.time_s, 1.0);
  EXPECT_EQ(source->start_ns(), 5 * second);
  EXPECT_EQ(source->notes().back(),
            "the pictures have no stamps: the times are those of the recording");
}

TEST(BagSource, WhichTopic) {
  const test::TemporaryFolder folder;
  McapBytes file;
  file.start().schema(1, image).schema(2, "std_msgs/msg/String");
  file.channel(1, 1, "/left")
      .channel(2, 1, "/right")
      .channel(3, 2, "/talk")
      .channel(4, 1, "/odd", "json");
  const auto path = written(
      folder, file.message(1, 1, picture(start, 1)).message(2, 1, picture(start, 2)).finish());
  EXPECT_TRUE(test::says(
      refusal(path),
      "has several topics with pictures: /left (sensor_msgs/msg/Image, 1 message), /odd"));
  EXPECT_TRUE(test::says(refusal(path), "choose one: --topic"));
  EXPECT_TRUE(test::says(refusal(path, "/gone"), "has no topic /gone; with pictures: /left"));
  EXPECT_TRUE(test::says(refusal(path, "/talk"), "/talk is std_msgs/msg/String, no pictures"));
  EXPECT_TRUE(test::says(refusal(path, "/odd"), "/odd is encoded as 'json', not as cdr"));
  Frame frame;
  ASSERT_EQ(opened(path, "/right")->grab(frame), Grab::frame);
  EXPECT_TRUE(test::says(refusal(written(folder, McapBytes().start().finish())), "holds no topic"));
  EXPECT_TRUE(test::says(refusal(written(folder, camera({}))), "/camera has no messages"));
}

TEST(BagSource, AFolderIsReadFileAfterFile) {
  const test::TemporaryFolder folder;
  written(folder, camera({picture(start, 1), picture(start + second, 2)}), "d_2.mcap");
  written(folder, camera({picture(start + 2 * second, 3)}), "d_10.mcap");
  const auto grays = [&] {
    const auto source = opened(folder.path().string());
    std::vector<int> found;
    Frame frame;
    while (source->grab(frame) == Grab::frame) found.push_back(frame.image.data[0]);
    EXPECT_EQ(source->frame_count(), std::optional<std::uint64_t>(found.size()));
    return found;
  };
  EXPECT_EQ(grays(), (std::vector<int>{1, 2, 3}));
  folder.write("metadata.yaml",
               "rosbag2_bagfile_information:\n  compression_format: \"\"\n  relative_file_paths:\n"
               "    - old_name/d_10.mcap\n  files:\n    - path: d_10.mcap\n");
  EXPECT_EQ(grays(), std::vector<int>{3});
  folder.write("metadata.yaml", "  compression_format: zstd\n");
  EXPECT_TRUE(test::says(refusal(folder.path().string()), "compressed by rosbag2 (zstd)"));
}

TEST(BagMetadata, WhatOldAndNewOnesSay) {
  const BagMetadata metadata = parse_metadata(
      "rosbag2_bagfile_information:\r\n  version: 9\r\n  relative_file_paths:\r\n    - "
      "\"x_0.db3\"\r\n"
      "    - '../../etc/x_1.db3'\r\n  compression_format: ''\r\n");
  EXPECT_EQ(metadata.files, (std::vector<std::string>{"x_0.db3", "x_1.db3"}));
  EXPECT_EQ(metadata.compression, "");
  EXPECT_TRUE(parse_metadata("").files.empty());
}

TEST(IsBag, ByNameOrByWhatIsInAFolder) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(is_bag("gone.mcap"));
  EXPECT_TRUE(is_bag("gone.db3"));
  EXPECT_FALSE(is_bag("drive.mp4"));
  EXPECT_FALSE(is_bag(folder.path()));
  folder.write("a.jpg", "");
  EXPECT_FALSE(is_bag(folder.path()));
  folder.write("a.db3", "");
  EXPECT_TRUE(is_bag(folder.path()));
}

}  // namespace
}  // namespace seqloop::bags
