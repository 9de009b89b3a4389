// SPDX-License-Identifier: MIT
// Who follows a drive has its places at once, whether or not the disk has them.
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "core/oracle.hpp"
#include "program/map/lasting_map.hpp"
#include "temporary_folder.hpp"

namespace seqloop::program {
namespace {

constexpr std::size_t size = 40;

/// A place, and which one it is a visit of.
struct Read {
  std::uint64_t frame = 0;
  std::vector<std::byte> bytes;
  std::optional<std::uint64_t> visits;
};
using ReadPlaces = std::map<std::uint64_t, Read>;  // by number

void add(ReadPlaces& places, const SavedPlace& place) {
  if (place.statistics) return;
  if (place.visits) {
    ASSERT_TRUE(places.contains(place.number)) << "a visit is told after its place";
    places[place.number].visits = place.visits;
    return;
  }
  ASSERT_FALSE(places.contains(place.number)) << place.number;
  places[place.number] = {place.frame, {place.bytes.begin(), place.bytes.end()}, {}};
}

class FollowedMap : public ::testing::Test {
 protected:
  void SetUp() override {
    settings_.file = folder_.path() / "m.seqloop";
    config_.use = Use::close_loops;
    config_.full_map = FullMap::forget_oldest;
    settings_.save_every_s = 3600.0;
    settings_.thumbnails = false;
  }

  /// Drives three laps. @return frames that became no place
  std::size_t drive(std::size_t room) {
    map_ = open_map(settings_, config_, size, "test");
    places_.emplace(config_, Capacity{room, size, 2});
    map_->load(*places_);
    map_->follow([this](std::int64_t, const SessionStatistics&) { ++learnt_; });
    if (at_once_) {
      follower_ = std::thread([this] {
        while (!over_) read_newest();
        read_newest();  // what came since
      });
    }
    saving_ = map_->begin(*places_, config_, "test");
    Detector detector(config_, *places_);
    std::size_t full = 0;
    std::uint64_t frame = 0;
    std::vector<FrameReport> reports(config_.frames_at_once);
    for (unsigned lap = 0; lap < 3; ++lap) {
      const oracle::Vectors seen =
          oracle::drive(1, 200, size, 0.1F + 0.01F * static_cast<float>(lap));
      for (std::size_t taken = 0; taken < seen.size();) {
        const std::vector<std::span<const float>> rest(
            seen.begin() + static_cast<std::ptrdiff_t>(taken), seen.end());
        const std::size_t count = detector.steps(rest, reports);
        for (const FrameReport& report : std::span(reports).first(count)) {
          map_->note(detector, report.newest, 7 + frame, static_cast<double>(frame) / 10, {},
                     report.answers, true);
          full += report.map_full;
          ++frame;
        }
        taken += count;
      }
    }
    saved_ = map_->saved();
    over_ = true;
    if (follower_.joinable()) follower_.join();
    EXPECT_EQ(map_->finish(detector, detector.finish()), std::nullopt);
    return full;
  }

  void read_newest() {
    map_->read_newest([this](const SavedPlace& place) { add(read_, place); });
  }

  MatcherConfig config_;
  test::TemporaryFolder folder_;
  MapSettings settings_;
  std::unique_ptr<LastingMap> map_;
  std::optional<PlaceMap> places_;
  LastingMap::Saving saving_;
  bool at_once_ = true;
  std::atomic<bool> over_{false};
  std::thread follower_;
  ReadPlaces read_;
  std::uint64_t saved_ = 0;
  std::atomic<int> learnt_{0};
};

TEST_F(FollowedMap, PlacesAreReadOnceAndAsTheyAreSaved) {
  EXPECT_EQ(drive(600), 0U);
  EXPECT_EQ(saved_, 0U) << "the disk had none of them";
  EXPECT_EQ(read_.size(), 600U) << "and all were read";
  read_newest();
  EXPECT_GT(learnt_, 0);
  ReadPlaces saved;
  map_->read_saved(2, [&](const SavedPlace& place) { add(saved, place); });
  ASSERT_EQ(read_.size(), saved.size());
  std::size_t visits = 0;
  for (const auto& [number, place] : saved) {
    EXPECT_EQ(read_[number].frame, place.frame);
    EXPECT_EQ(read_[number].bytes, place.bytes) << number;
    EXPECT_EQ(read_[number].visits, place.visits) << number;
    visits += place.visits.has_value();
  }
  EXPECT_GT(visits, 100U);
}

TEST_F(FollowedMap, OfMoreSessionsThanAreAskedForTheNewestAreRead) {
  at_once_ = false;
  for (int day = 0; day < 2; ++day) {
    saving_.reset();
    map_.reset();
    static_cast<void>(drive(1'200));
  }
  const auto sessions = [this](std::size_t most) {
    std::set<std::int64_t> found;
    map_->read_saved(most, [&found](const SavedPlace& place) { found.insert(place.began_ns); });
    return found;
  };
  const std::vector<std::int64_t> begun = map_->begun();
  EXPECT_EQ(sessions(2), std::set<std::int64_t>(begun.begin(), begun.end()));
  EXPECT_EQ(sessions(1), std::set<std::int64_t>{begun.back()});
}

TEST_F(FollowedMap, AFullMapForgetsNothingThatWasNotRead) {
  at_once_ = false;
  settings_.save_every_s = 0.001;
  EXPECT_GE(drive(250), 350U - 100) << "frames become no places";
  read_newest();
  ASSERT_EQ(read_.size(), 250U);
  EXPECT_EQ(read_.begin()->second.frame, 7U) << "as the source counts";
}

TEST_F(FollowedMap, AFullMapForgetsNothingThatWasNotReadWhenFramesComeTogether) {
  at_once_ = false;
  config_.frames_at_once = 50;
  settings_.save_every_s = 3600.0;
  constexpr std::size_t room = 270;  // it is full in the middle of a step
  EXPECT_EQ(drive(room), 600 - room) << "frames become no places";
  read_newest();
  ASSERT_EQ(read_.size(), room);
  EXPECT_EQ(read_.begin()->first, 0U);
  EXPECT_EQ(read_.rbegin()->first, room - 1);
}

}  // namespace
}  // namespace seqloop::program
