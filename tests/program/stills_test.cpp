// SPDX-License-Identifier: MIT
// Stills through the real binary: from a folder, from a video, and what can go wrong.
#include <opencv2/imgcodecs.hpp>

#include "platform/pictures.hpp"
#include "program/program.hpp"

namespace seqloop {
namespace {

class Stills : public test::Program {
 protected:
  void make_folder(int frames) const {
    std::filesystem::create_directory(file("drive"));
    for (int i = 0; i < frames; ++i) {
      folder_.write("drive/" + std::to_string(i) + ".png",
                    test::encoded(picture(static_cast<std::uint64_t>(i)), ".png"));
    }
  }

  static cv::Mat picture(std::uint64_t frame) { return test::textured(64, 32, frame + 1); }

  [[nodiscard]] cv::Mat still(const std::string& name) const {
    return cv::imread(file("out/" + name), cv::IMREAD_UNCHANGED);
  }

  void expect_fails(int exit_code, const std::string& arguments,
                    const std::vector<std::string>& words) const {
    SCOPED_TRACE(arguments);
    const std::string before = listing();
    const test::Outcome outcome = run("stills " + arguments);
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_TRUE(outcome.err.starts_with("seqloop: ")) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
    EXPECT_EQ(listing(), before) << "something was left";
  }
};

TEST_F(Stills, OfAFolderHaveTheirPixelsAndSayWhereTheyCameFrom) {
  make_folder(31);
  folder_.write("drive/20.png", "torn");
  const auto outcome =
      run("stills --source drive --out out --every-s 0.5 --leave-out 1.4-1.6 --crop 48x32+8+0");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("6 stills in out"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("frame 20: 20.png"), std::string::npos) << outcome.err;
  EXPECT_EQ(test::read_all(file("out/stills.csv")),
            "still,source_frame,time_s\n0,0,0\n1,5,0.5\n2,10,1\n3,20,2\n4,25,2.5\n5,30,3\n");
  EXPECT_EQ(std::filesystem::file_size(file("out/000003.png")), 0U);
  const cv::Mat wanted = picture(25)(cv::Rect(8, 0, 48, 32));
  const cv::Mat found = still("000004.png");
  ASSERT_EQ(found.size(), wanted.size());
  EXPECT_EQ(cv::norm(found, wanted, cv::NORM_INF), 0.0);

  const auto described = run("describe --source out --out d.npy");
  EXPECT_EQ(described.exit_code, 0);
  EXPECT_NE(described.err.find("6 frames"), std::string::npos) << described.err;
  EXPECT_NE(described.err.find("1 unreadable"), std::string::npos) << described.err;
}

TEST_F(Stills, OfAVideoAreShapedAsThePaperHasIt) {
  const std::string street = "'" SEQLOOP_STREET_BINARY
                             "' --quiet --size 320x180 --frames 45 --format avi --drives loop "
                             "--out '" +
                             file("drive") + "'";
  ASSERT_EQ(std::system(street.c_str()), 0);
  const std::string take = "stills --source drive/drive.avi --every-s 1 --from-s 1 --size 640x320 ";
  ASSERT_EQ(run(take + "--crop 480x320+80+0 --out out").exit_code, 0);
  ASSERT_EQ(run(take + "--crop 480x320+100+0 --format jpg --gray --out shifted").exit_code, 0);
  EXPECT_EQ(test::read_all(file("out/stills.csv")),
            "still,source_frame,time_s\n0,10,1\n1,20,2\n2,30,3\n3,40,4\n");
  const cv::Mat whole = still("000002.png");
  const cv::Mat shifted = cv::imread(file("shifted/000002.jpg"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(whole.size(), cv::Size(480, 320));
  ASSERT_EQ(shifted.size(), cv::Size(480, 320));
  EXPECT_EQ(whole.channels(), 3);
  EXPECT_EQ(shifted.channels(), 1);
  cv::Mat gray;
  cv::cvtColor(whole, gray, cv::COLOR_BGR2GRAY);
  const auto apart = [&](int shift) {
    const cv::Rect from(shift, 0, 480 - shift, 320);
    return cv::norm(gray(from), shifted(cv::Rect(0, 0, 480 - shift, 320)), cv::NORM_L1) /
           static_cast<double>(from.area());
  };
  EXPECT_LT(apart(20), 2.0) << "20 pixels further right, but for what the JPEG loses";
  EXPECT_GT(apart(0), 2.0 * apart(20));
}

TEST_F(Stills, TakeAnEmptyFoldersPlaceAndNoOther) {
  make_folder(3);
  std::filesystem::create_directory(file("out"));
  EXPECT_EQ(run("stills --source drive --out out/").exit_code, 0);
  EXPECT_TRUE(exists("out/000002.png"));
  expect_fails(2, "--source drive --out out", {"out", "no empty folder"});
  expect_fails(2, "--source drive --out drive", {"drive", "no empty folder"});
  expect_fails(2, "--source drive --out drive/0.png", {"no empty folder"});
  expect_fails(2, "--source drive --out none/out", {"none first"});
}

TEST_F(Stills, EveryFaultAtOnce) {
  make_folder(3);
  expect_fails(2,
               "--source none --out none/x --every-s -1 --from-s 5 --to-s 5 --size 64x32 "
               "--crop 48x32+20+0 --leave-out 9-3 --format gif --fps x --cropp 3",
               {"none: ", "none/x", "every-s", "to-s", "48x32+20+0", "9 to 3", "'gif'", "'x'",
                "did you mean --crop"});
  expect_fails(2, "", {"source: not given", "out: not given"});
  expect_fails(2, "--source drive --out out --crop 48x33+8+0", {"48x33+8+0", "64x32"});
  expect_fails(2, "--source drive --out out --crop 48x32-8+0", {"crop"});
  expect_fails(2, "--source drive --out out --fps 0", {"frame rate"});
  expect_fails(2, "--source drive --out out --from-s 99", {"--from-s"});
  expect_fails(2, "--source drive.npy --out out", {"descriptors"});
  folder_.write("gaps.csv", "from_s,to_s\n1,x\n");
  expect_fails(2, "--source drive --out out --leave-out gaps.csv", {"gaps.csv:2", "'x'"});
  folder_.write("gaps.csv", "from_s\n1\n");
  expect_fails(2, "--source drive --out out --leave-out gaps.csv", {"to_s"});
  folder_.write("gaps.csv", "from_s,to_s\n0.05,0.15\n");
  EXPECT_EQ(run("stills --source drive --out out --leave-out gaps.csv").exit_code, 0);
  EXPECT_EQ(test::read_all(file("out/stills.csv")), "still,source_frame,time_s\n0,0,0\n1,2,0.2\n");
  for (int i = 0; i < 3; ++i) folder_.write("drive/" + std::to_string(i) + ".png", "torn");
  expect_fails(2, "--source drive --out out2", {"none of the frames"});
}

TEST_F(Stills, AFullDiskLeavesNothing) {
  make_folder(3);
  // A limit on file sizes stands for the disk.
  folder_.write("limited.sh", "ulimit -f 2; trap '' XFSZ; exec \"$@\"\n");
  const std::string before = listing();
  const std::string command = "cd '" + folder_.path().string() +
                              "' && sh limited.sh '" SEQLOOP_BINARY
                              "' stills --source drive --out out 2>stderr.txt";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_NE(
      test::read_all(file("stderr.txt")).find("000000.png: cannot be written: File too large"),
      std::string::npos)
      << test::read_all(file("stderr.txt"));
  EXPECT_EQ(listing(), before);
}

TEST_F(Stills, InterruptedLeaveNothing) {
  make_folder(1);
  for (int i = 1; i < 30'000; ++i) {
    std::filesystem::create_hard_link(file("drive/0.png"),
                                      file("drive/" + std::to_string(i) + ".png"));
  }
  folder_.write("stop.sh",
                "env --default-signal=INT,TERM,HUP \"$@\" &\n"
                "until ls -d .out.partial-* >/dev/null 2>&1; do sleep 0.01; done\n"
                "kill -INT $!; wait $!\n");
  const std::string before = listing();
  // Also while it passes over frames, and none is a still.
  for (const std::string more : {"", " --from-s 99999"}) {
    const std::string command =
        "cd '" + folder_.path().string() +
        "' && sh stop.sh '" SEQLOOP_BINARY "' stills --source drive --out out 2>stderr.txt" + more;
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    EXPECT_NE(test::read_all(file("stderr.txt")).find("interrupted"), std::string::npos)
        << test::read_all(file("stderr.txt"));
    EXPECT_EQ(listing(), before);
  }
}

}  // namespace
}  // namespace seqloop
