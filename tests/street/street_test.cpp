// SPDX-License-Identifier: MIT
// The synthetic street: same flags, same frames; truth that is true; any length and size.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "options.hpp"
#include "renderer.hpp"
#include "shade.hpp"
#include "speed.hpp"

namespace seqloop::street {
namespace {

namespace fs = std::filesystem;

Job job_of(Options o) {
  o.out = "somewhere";
  std::vector<std::string> faults;
  const auto job = check(o, faults);
  EXPECT_TRUE(job.has_value()) << (faults.empty() ? "" : faults.front());
  return job.value_or(Job{});
}

Job small_job(std::size_t frames, std::uint64_t seed = 1, const std::string& drives = "localise",
              std::size_t kidnaps = 0) {
  Options o;
  o.frames = frames;
  o.seed = seed;
  o.drives = drives;
  o.kidnaps = kidnaps;
  o.size = "64x32";
  return job_of(o);
}

Drive reference_of(const Job& job) { return {Street(job.seed), localise_plan(job, false)}; }
Drive query_of(const Job& job) { return {Street(job.seed), localise_plan(job, true)}; }
Drive loop_of(const Job& job) { return {Street(job.seed), loop_plan(job)}; }

/// Hash of each picture of a drive.
std::vector<std::uint64_t> prints(const Drive& drive, int width = 64, int height = 32) {
  Renderer renderer(drive.path(), width, height);
  std::vector<std::uint64_t> out;
  cv::Mat image;
  for (std::size_t i = 0; i < drive.frames(); ++i) {
    renderer.render(drive.shot(i), image);
    EXPECT_EQ(image.cols, width);
    EXPECT_EQ(image.rows, height);
    std::uint64_t h = 0;
    for (std::size_t k = 0; k < image.total() * image.elemSize(); ++k)
      h = hash_of(h, image.data[k]);
    out.push_back(h);
  }
  return out;
}

/// An empty folder that goes away with the test.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "street-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder");
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  fs::path path;
};

TEST(StreetFrames, SameSeedSameFramesOtherSeedOtherFrames) {
  const auto once = prints(query_of(small_job(40)));
  EXPECT_EQ(once, prints(query_of(small_job(40))));
  const auto other = prints(query_of(small_job(40, 2)));
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_NE(once[i], other[i]);
}

TEST(StreetFrames, AFrameDoesNotDependOnTheFramesBeforeIt) {
  const Drive drive = loop_of(small_job(300, 3, "loop"));
  Renderer renderer(drive.path(), 64, 32);
  cv::Mat first, again, between;
  renderer.render(drive.shot(17), first);
  renderer.render(drive.shot(250), between);
  renderer.render(drive.shot(17), again);
  EXPECT_EQ(0, std::memcmp(first.data, again.data, first.total() * first.elemSize()));
}

TEST(StreetFrames, NoTwoAlikeEvenAtHalts) {
  const Job job = small_job(300);
  std::set<std::uint64_t> seen;
  for (const Drive& drive : {reference_of(job), query_of(job)}) {
    std::size_t halted = 0;
    for (std::size_t i = 1; i < drive.frames(); ++i) {
      halted += drive.position(i) <= drive.position(i - 1) ? 1U : 0U;
    }
    EXPECT_GE(halted, 3U);
    for (const std::uint64_t print : prints(drive)) EXPECT_TRUE(seen.insert(print).second);
  }
}

TEST(StreetFrames, AnySizeAndPicturesWithContent) {
  const Drive drive = reference_of(small_job(3));
  for (const cv::Size size : {cv::Size(16, 16), cv::Size(64, 32), cv::Size(37, 91),
                              cv::Size(320, 180), cv::Size(640, 360)}) {
    Renderer renderer(drive.path(), size.width, size.height);
    cv::Mat image, grey;
    renderer.render(drive.shot(1), image);
    ASSERT_EQ(image.size(), size);
    ASSERT_EQ(image.type(), CV_8UC3);
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    EXPECT_GT(deviation[1], 15.0);
    EXPECT_GT(mean[1], 30.0);
    EXPECT_LT(mean[1], 225.0);
  }
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  cv::Mat found;
  cv::matchTemplate(a, b, found, cv::TM_CCOEFF_NORMED);
  return static_cast<double>(found.at<float>(0));
}

TEST(StreetFrames, TheSameMetreOfAnotherStreetHasAnotherRoad) {
  const auto road = [](std::uint64_t seed) {
    const Job job = small_job(20, seed);
    Scene scene;
    build_scene(World(seed), reference_of(job).path(), reference_of(job).shot(0), 64, 32, scene);
    Strip strip = scene.strips.front();
    strip.crossing = false;
    std::vector<float> tones;
    for (strip.cell = 0; strip.cell < 40; ++strip.cell) {
      for (float d = 0.5F; d < 3.0F; d += 0.5F)  // between its markings
        tones.push_back(paint_ground(strip, {0.0F, d, 0.01F, 0.01F}, Light{}).albedo.r);
    }
    return tones;
  };
  EXPECT_GT(correlation(road(1), road(1)), 0.999);
  EXPECT_LT(correlation(road(1), road(2)), 0.2);
}

TEST(StreetFrames, HillsAreTheStreetsAndCloudsAreTheDrives) {
  const Job job = small_job(20);
  constexpr int width = 64;
  constexpr int height = 32;
  GBuffer nothing(width, height);
  nothing.clear();
  const Camera camera = make_camera({0.0, 0.0, 1.6}, 0.0, 0.0, 0.0, width, height);
  const auto sky = [&](const Drive& drive, std::uint64_t street) {
    Shot shot = drive.shot(0);
    shot.light = Light{};
    std::vector<Color> picture(static_cast<std::size_t>(width) * height);
    shade_sky(camera, shot, 0.0, street, nothing, picture);
    std::vector<float> above;
    std::vector<float> hills;
    for (std::size_t i = 0; i < picture.size() / 2; ++i)
      (i < picture.size() / 4 ? above : hills).push_back(picture[i].r);
    return std::pair(above, hills);
  };
  const auto summer = sky(reference_of(job), 1);
  const auto elsewhere = sky(reference_of(job), 2);
  const auto winter = sky(query_of(job), 1);
  EXPECT_EQ(summer.first, elsewhere.first);
  EXPECT_NE(summer.second, elsewhere.second);
  EXPECT_LT(correlation(summer.first, winter.first), 0.5);
}

TEST(StreetSpeed, ExactLengthAndNeverBackwards) {
  EXPECT_EQ(positions(1, 1.0, 5), std::vector<double>{0.0});
  for (const std::size_t frames : {2U, 3U, 59U, 60U, 61U, 300U, 2000U}) {
    const auto length = static_cast<double>(frames);
    const auto at = positions(frames, length, 5);
    ASSERT_EQ(at.size(), frames);
    EXPECT_EQ(at.front(), 0.0);
    EXPECT_EQ(at.back(), length);
    for (std::size_t i = 1; i < frames; ++i) {
      EXPECT_GE(at[i], at[i - 1]);
      EXPECT_LE(at[i] - at[i - 1], 2.5);
    }
  }
}

TEST(StreetRoute, HeadingIsContinuousWhereLegsAreJoined) {
  const Drive drive = loop_of(small_job(1500, 4, "loop"));
  const Path& path = drive.path();
  std::size_t old = 0;
  for (std::size_t k = 1; k < path.legs().size(); ++k) {
    old += path.legs()[k].fresh ? 0U : 1U;
    const double p = path.begin(k);
    const double turn = wrap_angle(path.heading(k, p) - path.heading(k - 1, p));
    EXPECT_NEAR(turn, 0.0, 1e-9) << "leg " << k;
  }
  EXPECT_GE(old, 3U);
}

TEST(StreetTruth, LocaliseHasOneRowAFrameNearestOnTheStreet) {
  for (const std::size_t frames : {1U, 2U, 7U, 300U}) {
    const Job job = small_job(frames, 6);
    const Drive reference = reference_of(job), query = query_of(job);
    const auto rows = localise_truth(query, reference);
    ASSERT_EQ(rows.size(), frames);
    for (std::size_t i = 0; i < frames; ++i) {
      EXPECT_EQ(rows[i].query, i);
      ASSERT_LT(rows[i].reference, frames);
      const double here = std::fabs(query.street(i) - reference.street(rows[i].reference));
      for (std::size_t r = 0; r < frames; ++r) {
        EXPECT_LE(here, std::fabs(query.street(i) - reference.street(r)) + 1e-9);
      }
    }
  }
}

TEST(StreetTruth, LoopRowsAreOldNearAndOnOldLegsOnly) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    for (const std::size_t frames : {1U, 2U, 100U, 259U, 260U, 400U, 1200U}) {
      const Drive drive = loop_of(small_job(frames, seed, "loop"));
      ASSERT_EQ(drive.frames(), frames);
      EXPECT_NEAR(drive.path().length(), static_cast<double>(frames), 1e-6);
      std::set<std::size_t> legs;
      std::set<std::size_t> queries;
      for (const TruthRow& row : loop_truth(drive)) {
        ASSERT_LT(row.query, frames);
        EXPECT_GT(row.query, row.reference + kLoopAge);
        EXPECT_LT(std::fabs(drive.street(row.query) - drive.street(row.reference)), 2.0);
        EXPECT_FALSE(drive.path().legs()[drive.leg(row.query)].fresh);
        legs.insert(drive.leg(row.query));
        queries.insert(row.query);
      }
      if (frames < 260) {
        EXPECT_TRUE(legs.empty());
      }
      if (frames >= 400) {
        EXPECT_GE(legs.size(), 2U) << "seed " << seed << " frames " << frames;
        EXPECT_GT(queries.size(), frames / 8);
        EXPECT_LT(queries.size(), frames * 3 / 4);
      }
    }
  }
}

TEST(StreetTruth, NoEarlierVisitIsLeftOut) {
  const Drive drive = loop_of(small_job(900, 2, "loop"));
  const auto rows = loop_truth(drive);
  std::set<std::size_t> known;
  for (const TruthRow& row : rows) known.insert(row.query);
  for (std::size_t i = kLoopAge + 1; i < drive.frames(); ++i) {
    if (known.count(i) != 0) continue;
    for (std::size_t r = 0; r + kLoopAge + 5 < i; ++r) {
      if (drive.leg(r) == drive.leg(i)) break;
      EXPECT_GT(std::fabs(drive.street(i) - drive.street(r)), 0.5) << i << " and " << r;
    }
  }
}

/// Where the camera of a path metre is, seen from another: in steps of a tenth of a metre.
cv::Point2d seen_from(const Path& path, double from, double to) {
  const int steps = static_cast<int>(std::ceil(std::fabs(to - from) / 0.1));
  cv::Point2d at(0.0, 0.0);
  for (int i = 0; i < steps; ++i) {
    const double step = (to - from) / steps;
    const double p = from + step * (i + 0.5);
    const double heading = path.heading(path.leg_at(p), p);
    at += step * cv::Point2d(std::cos(heading), std::sin(heading));
  }
  return at;
}

TEST(StreetTruth, NearRowsAreThosePastAJunctionByDistance) {
  const Street street(3);
  DrivePlan plan;
  plan.frames = 520;
  // A road that joins the first one at its 160th metre, and one that leaves it at its 250th.
  plan.legs = {{0.0, 300.0, true, false}, {160.0, 90.0, false, true}, {900.0, 130.0, true, true}};
  const Drive drive(street, plan);
  constexpr double near = 10.0;
  std::set<std::pair<std::size_t, std::size_t>> found;
  for (const NearRow& row : near_truth(drive, near)) {
    ASSERT_LE(row.first, row.last);
    for (std::size_t r = row.first; r <= row.last; ++r) {
      EXPECT_TRUE(found.insert({row.query, r}).second) << row.query << " twice with " << r;
    }
  }
  const auto [joins, leaves] = std::pair(300.0, 390.0);
  std::size_t pairs = 0;
  for (std::size_t q = 0; q < drive.frames(); ++q) {
    for (std::size_t r = 0; r + kLoopAge < q; ++r) {
      if (std::fabs(drive.street(q) - drive.street(r)) <= 2.0 * near) continue;
      double least = 1e9;
      for (const auto& [junction, on_first] : {std::pair(joins, 160.0), std::pair(leaves, 250.0)}) {
        const double a = drive.position(q);
        const double b = drive.position(r);
        if (std::fabs(a - junction) > 100.0 || std::fabs(b - on_first) > 100.0) continue;
        // Far along one road and near along the other cannot be near.
        if (std::fabs((a - junction) - (b - on_first)) > 4.0 * near) continue;
        const Path& path = drive.path();
        const double turn = path.heading(path.leg_at(a), a) - path.heading(path.leg_at(b), b);
        if (std::fabs(wrap_angle(turn)) > 0.785) continue;
        least =
            std::min(least, cv::norm(seen_from(path, junction, a) - seen_from(path, on_first, b)));
      }
      if (std::fabs(least - near) < 0.1) continue;  // either way
      pairs += least < near ? 1U : 0U;
      EXPECT_EQ(found.contains({q, r}), least < near) << q << " and " << r << ": " << least;
    }
  }
  EXPECT_GT(pairs, 200U);
}

TEST(StreetTruth, NothingIsNearAcrossAKidnapOrOnOneRoad) {
  DrivePlan plan;
  plan.frames = 500;
  plan.legs = {{0.0, 300.0, true, false}, {40.0, 200.0, false, false}};
  EXPECT_TRUE(near_truth(Drive(Street(3), plan), 10.0).empty());
  EXPECT_TRUE(near_truth(reference_of(small_job(300, 4)), 10.0).empty());
  EXPECT_TRUE(near_truth(loop_of(small_job(1, 4, "loop")), 10.0).empty());
}

TEST(StreetTruth, KidnapsAreAsManyAsAskedFor) {
  for (const std::size_t kidnaps : {0U, 1U, 2U, 3U}) {
    const Drive drive = loop_of(small_job(1500, 7, "loop", kidnaps));
    EXPECT_EQ(count_kidnaps(drive.path().legs()), kidnaps);
    EXPECT_FALSE(loop_truth(drive).empty());
  }
}

TEST(StreetOptions, AllFaultsAreListed) {
  Options o;
  o.frames = 0;
  o.drives = "sideways";
  o.size = "12by3";
  o.format = "gif";
  o.first_light = "moon";
  o.length = -1.0;
  o.kidnaps = 2;
  std::vector<std::string> faults;
  EXPECT_FALSE(check(o, faults).has_value());
  EXPECT_EQ(faults.size(), 8U);
  for (const std::string size : {"8x64", "64x5000", "64x64x", "x64", "64x", "-64x64", ""}) {
    Options wrong;
    wrong.out = "somewhere";
    wrong.size = size;
    faults.clear();
    EXPECT_FALSE(check(wrong, faults).has_value()) << size;
    EXPECT_EQ(faults.size(), 1U);
  }
  Options many;
  many.out = "somewhere";
  many.drives = "loop";
  many.kidnaps = 100;
  faults.clear();
  EXPECT_FALSE(check(many, faults).has_value());
}

TEST(StreetOutput, FormatsHoldEveryFrame) {
  const Scratch scratch;
  const cv::Mat image(32, 64, CV_8UC3, cv::Scalar(10, 200, 90));
  for (const Format format : {Format::jpg, Format::png, Format::avi}) {
    const auto sink = open_sink(scratch.path, "drive", format, image.size());
    for (int i = 0; i < 3; ++i) sink->put(image);
    sink->close();
  }
  EXPECT_EQ(cv::imread((scratch.path / "drive/000002.jpg").string()).size(), image.size());
  const cv::Mat back = cv::imread((scratch.path / "drive/000000.png").string());
  EXPECT_EQ(0.0, cv::norm(back, image, cv::NORM_INF));
  EXPECT_FALSE(fs::exists(scratch.path / "drive/000003.jpg"));
  cv::VideoCapture video((scratch.path / "drive.avi").string());
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_COUNT), 3.0);
}

TEST(StreetOutput, OnlyCompleteFoldersOfOurOwnAreReplaced) {
  const Scratch scratch;
  const fs::path target = scratch.path / "made";
  {
    const Staging unfinished(target);
    write_file(unfinished.folder() / "a", "1");
  }
  EXPECT_TRUE(fs::is_empty(scratch.path));
  for (const std::string content : {"near.csv", "truth.csv"}) {
    Staging staging(target);
    write_file(staging.folder() / content, content);
    EXPECT_FALSE(fs::exists(target / content));
    staging.commit("seed 1\n");
    EXPECT_TRUE(fs::exists(target / content));
  }
  EXPECT_FALSE(fs::exists(target / "near.csv"));
  EXPECT_TRUE(Staging::holds(target, "seed 1\n"));
  EXPECT_FALSE(Staging::holds(target, "seed 2\n"));
  const fs::path foreign = scratch.path / "foreign";
  fs::create_directory(foreign);
  write_file(foreign / "thesis.txt", "not yours");
  EXPECT_THROW(Staging{foreign}, std::runtime_error);
  EXPECT_TRUE(fs::exists(foreign / "thesis.txt"));
  EXPECT_THROW(write_file(scratch.path / "no/such/folder", "x"), std::runtime_error);
}

TEST(StreetOutput, WhatOthersPutBesideADriveIsNotLost) {
  const Scratch scratch;
  const fs::path target = scratch.path / "made";
  for (int i = 0; i < 2; ++i) {
    Staging staging(target);
    open_sink(staging.folder(), "query", Format::jpg, {32, 32})->put(cv::Mat(32, 32, CV_8UC3));
    staging.commit("seed 1\n");
  }
  for (const char* name : {"answers.jsonl", "drive.npy", "query/notes.txt", "query/000001.npy"}) {
    write_file(target / name, "mine");
    EXPECT_THROW(Staging{target}, std::runtime_error) << name;
    EXPECT_TRUE(fs::remove(target / name)) << name;
  }
  EXPECT_NO_THROW(Staging{target});
}

TEST(StreetOutput, ADiskWithoutRoomIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(write_file("/dev/full", std::string(100'000, 'x')), std::runtime_error);
}

}  // namespace
}  // namespace seqloop::street
