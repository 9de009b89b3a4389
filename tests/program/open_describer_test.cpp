// SPDX-License-Identifier: MIT
// Describers that learn from drives at hand, as an experiment opens them.
#include <gtest/gtest.h>

#include <array>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "expect_setup_error.hpp"
#include "program/drives/drives.hpp"
#include "seqloop/opencv/threads.hpp"
#include "synthetic_drive.hpp"

namespace seqloop::program {
namespace {

using test::SyntheticDrive;

/// What describers learned from pictures of `seed` say of one more.
std::vector<float> described(const DriveSettings& settings, std::uint64_t seed) {
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < 5; ++i) pictures.push_back(test::textured(160, 120, seed + i));
  SyntheticDrive drive(pictures);
  const std::array<FrameSource*, 1> training{&drive};
  const std::unique_ptr<Describer> describer = open_describer(settings, training);
  std::vector<float> descriptor(describer->size());
  EXPECT_EQ(describer->describe(test::image_of(test::textured(160, 120, 99)), descriptor),
            Description::good);
  return descriptor;
}

TEST(OpenDescriber, LearnsTheSameOnTwoThreadsAtOnce) {
  DriveSettings words;
  words.descriptor = "words";
  words.words = 150;
  DriveSettings removal;
  removal.remove_components = 3;
  for (const DriveSettings& settings : {words, removal}) {
    const auto first = described(settings, 1);
    const auto second = described(settings, 50);
    EXPECT_NE(first, second);
    std::array<std::vector<float>, 2> at_once;
    std::thread other([&] { at_once[1] = described(settings, 50); });
    at_once[0] = described(settings, 1);
    other.join();
    EXPECT_EQ(at_once[0], first);
    EXPECT_EQ(at_once[1], second);
  }
}

TEST(OpenDescriber, ThreadsMayAskForOneThreadAtOnce) {
  const auto ask = [] {
    for (int i = 0; i < 100'000; ++i) opencv::use_threads(1);
  };
  std::thread other(ask);
  ask();
  other.join();
  EXPECT_EQ(cv::getNumThreads(), 1);
}

TEST(OpenDescriber, NeedsTheDrivesThatItIsGivenAndNoOthers) {
  DriveSettings settings;
  settings.descriptor = "words";
  settings.training = {"none"};
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)open_describer(settings, {}); }),
                         "training: not given"));
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)open_describer(settings); }),
                         "none: does not exist"));
  settings.words = 100;
  EXPECT_EQ(described(settings, 1).size(), 100U);
}

}  // namespace
}  // namespace seqloop::program
