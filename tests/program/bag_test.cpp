// SPDX-License-Identifier: MIT
// Bags through the real program: the same answers as from the folder, what a bag holds, refusals.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "bags/bag_bytes.hpp"
#include "program/program.hpp"

namespace seqloop {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t start = 1'700'000'000'000'000'000;

class Bags : public test::Program {
 protected:
  /// A street driven round and round, as a folder and as a bag, 10 frames a second.
  void SetUp() override {
    std::filesystem::create_directory(file("drive"));
    test::McapBytes bag;
    bag.start().schema(1, "sensor_msgs/msg/CompressedImage").channel(1, 1, "/camera");
    cv::RNG random(7);
    std::vector<cv::Mat> places(150);
    for (cv::Mat& place : places) {
      cv::Mat coarse(6, 8, CV_8UC1);
      random.fill(coarse, cv::RNG::UNIFORM, 0, 256);
      cv::resize(coarse, place, {64, 48}, 0, 0, cv::INTER_CUBIC);
    }
    for (int i = 0; i < 300; ++i) {
      std::vector<std::uint8_t> png;
      cv::imencode(".png", places[static_cast<std::size_t>(i) % places.size()], png);
      folder_.write("drive/" + std::to_string(i) + ".png", std::string(png.begin(), png.end()));
      const std::int64_t time = start + i * std::int64_t{100'000'000};
      bag.message(1, static_cast<std::uint64_t>(time), test::compressed_message(time, "png", png));
    }
    bag.finish();
    folder_.write("drive.mcap", std::string(bag.bytes.begin(), bag.bytes.end()));
  }

  static std::vector<Json> lines(const std::string& text) {
    std::vector<Json> all;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
      Json json = Json::parse(line);
      for (const char* key : {"latency_ms", "deadline_missed", "missed", "overloaded"})
        json.erase(key);
      all.push_back(std::move(json));
    }
    return all;
  }
};

TEST_F(Bags, TheSameAnswersAsFromTheFolder) {
  const test::Outcome folder = run("run --source drive");
  const test::Outcome bag = run("run --source drive.mcap --out-bag loops.mcap");
  ASSERT_EQ(folder.exit_code, 0) << folder.err;
  ASSERT_EQ(bag.exit_code, 0) << bag.err;
  EXPECT_EQ(lines(bag.out), lines(folder.out));
  std::size_t accepted = 0;
  for (const Json& line : lines(bag.out))
    for (const Json& answer : line["answers"]) accepted += answer["status"] == "match" ? 1U : 0U;
  EXPECT_GT(accepted, 10U);
  const test::Outcome info = run("bag info loops.mcap --json");
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const Json facts = Json::parse(info.out);
  EXPECT_EQ(facts["topics"][0]["name"], "/seqloop/loop_closures");
  EXPECT_EQ(facts["topics"][0]["type"], "seqloop_msgs/msg/LoopClosure");
  EXPECT_EQ(facts["topics"][0]["messages"], accepted);
  EXPECT_GE(facts["start_ns"], start);
  EXPECT_TRUE(facts["notes"].empty());
}

TEST_F(Bags, WhatIsWrongWithAllPicturesIsSaidOnce) {
  test::McapBytes bag;
  bag.start().schema(1, "sensor_msgs/msg/Image").channel(1, 1, "/camera");
  for (int i = 0; i < 50; ++i) {
    const std::int64_t time = start + i * std::int64_t{100'000'000};
    const char* const encoding = i < 40 ? "bayer_rggb8" : "32FC1";
    bag.message(1, static_cast<std::uint64_t>(time),
                test::image_message(time, 8, 6, encoding, 32, std::vector<std::uint8_t>(192)));
  }
  bag.finish();
  folder_.write("bayer.mcap", std::string(bag.bytes.begin(), bag.bytes.end()));
  for (const std::string verb : {"run --source bayer.mcap --ds 4 --out o.jsonl --pictures drawn",
                                 "describe --source bayer.mcap --out d.npy",
                                 "run --source drive --reference bayer.mcap --ds 4 --out o.jsonl",
                                 "stills --source bayer.mcap --every-s .1 --out stills"}) {
    const test::Outcome outcome = run(verb);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_FALSE(exists("drawn")) << "nothing was drawn";
    EXPECT_LT(std::ranges::count(outcome.err, '\n'), 20) << verb << outcome.err;
    for (const char* word : {"frame 0: pictures of the encoding 'bayer_rggb8' are not read",
                             "frame 1: the same", "frame 40: pictures of the encoding '32FC1'"}) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << verb << outcome.err;
    }
  }
}

TEST_F(Bags, LoopsSayOfWhichSessionTheirPlacesAre) {
  if (SEQLOOP_MAPS == 0) GTEST_SKIP() << "this build keeps no maps in files";
  const std::string drive = "run --source drive.mcap --out /dev/null --exclude 20 ";
  ASSERT_EQ(run(drive + "--map m.seqloop --session monday").exit_code, 0);
  const test::Outcome second =
      run(drive + "--map m.seqloop --session tuesday --out-bag loops.mcap");
  ASSERT_EQ(second.exit_code, 0) << second.err;
  const std::string bag = test::read_all(file("loops.mcap"));
  // Serialised: 7 bytes with the zero behind them.
  EXPECT_NE(bag.find(std::string("\7\0\0\0monday\0", 11)), std::string::npos);
  ASSERT_EQ(run(drive + "--out-bag alone.mcap").exit_code, 0);
  EXPECT_EQ(test::read_all(file("alone.mcap")).find("monday"), std::string::npos);
}

TEST_F(Bags, WhatOneHolds) {
  const test::Outcome outcome = run("bag info drive.mcap");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* word : {"MCAP\n", "29.900 seconds", "/camera", "sensor_msgs/msg/CompressedImage",
                           "300", "no full summary"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word << " in\n" << outcome.out;
  EXPECT_EQ(run("bag info gone.mcap").exit_code, 2);
  EXPECT_EQ(run("bag").exit_code, 2);
  EXPECT_EQ(run("bag burn drive.mcap").exit_code, 2);
  EXPECT_EQ(run("bag info drive.mcap drive.mcap").exit_code, 2);
}

TEST_F(Bags, Refusals) {
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
  };
  refused("run --source drive.mcap --topic /gone", "has no topic /gone; with pictures: /camera");
  refused("run --source drive.mcap --out-bag drive.mcap", "would destroy an input");
  refused("run --source drive.mcap --out-bag a.mcap --out a.mcap", "is the same file");
  refused("describe --source drive/0.mcap --out d.npy", "does not exist");
}

}  // namespace
}  // namespace seqloop
