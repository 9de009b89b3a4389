// SPDX-License-Identifier: MIT
// What drives get wrong, through the real binary: damaged pictures, videos whose headers lie.
#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>
#include <random>
#include <sstream>

#include "platform/pictures.hpp"
#include "program/program.hpp"

namespace seqloop {
namespace {

class DriveFaults : public test::Program {
 protected:
  /// 50 frames of a motion JPEG, 20 a second. @return the file's bytes
  [[nodiscard]] std::string video() const {
    {
      cv::VideoWriter writer(file("made.avi"), cv::CAP_OPENCV_MJPEG,
                             cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, cv::Size(64, 48));
      for (std::uint64_t i = 0; i < 50; ++i) writer.write(test::textured(64, 48, i + 1));
    }
    return test::read_all(file("made.avi"));
  }

  static void set_number(std::string& bytes, std::size_t place, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes.at(place + i) = static_cast<char>(value >> 8 * i);
  }

  [[nodiscard]] std::vector<nlohmann::json> lines(const std::string& name) const {
    std::istringstream text(test::read_all(file(name)));
    std::vector<nlohmann::json> all;
    for (std::string line; std::getline(text, line);) all.push_back(nlohmann::json::parse(line));
    return all;
  }

  static void expect_says(const test::Outcome& outcome, int exit_code,
                          const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
  }
};

TEST_F(DriveFaults, ADamagedJpegIsAFrameError) {
  std::filesystem::create_directory(file("drive"));
  for (int i = 0; i < 30; ++i) {
    std::string jpeg =
        test::encoded(test::textured(160, 120, static_cast<std::uint64_t>(i) + 1), ".jpg");
    std::mt19937 random(3);  // not all damage leaves codes behind that are wrong
    for (std::size_t k = 0; i == 7 && k < 100; ++k)
      jpeg.at(jpeg.size() / 2 + k) = static_cast<char>(random());
    folder_.write("drive/" + std::to_string(i) + ".jpg", jpeg);
  }
  expect_says(run("run --source drive --ds 4 --exclude 10 --out r.jsonl"), 0,
              {"frame 7: 7.jpg: the JPEG picture is damaged (", "1 frame_error"});
  EXPECT_EQ(lines("r.jsonl").at(7)["status"], "frame_error");
  expect_says(
      run("describe --source drive --out d.npy"), 0,
      {"frame 7: 7.jpg: the JPEG picture is damaged", "rows of zeros: 1 unreadable frame\n"});
  expect_says(run("run --source drive --reference drive --ds 4 --out r.jsonl"), 0,
              {"reference frame 7: 7.jpg: the JPEG picture is damaged"});
}

TEST_F(DriveFaults, AVideoThatPromisesTooMuchIsNamed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers end a process that asks for terabytes";
#endif
  std::string bytes = video();
  set_number(bytes, bytes.find("avih") + 8 + 16, 1U << 31U);
  set_number(bytes, bytes.find("strh") + 8 + 32, 1U << 31U);
  folder_.write("big.avi", bytes);
  folder_.write("drive.avi", video());
  const std::string ds = " --ds 4 --exclude 10 --out r.jsonl";
  const std::vector<std::string> words{
      "max-places: not given, and big.avi declares 2147483648 frames", "--max-places N",
      "memory: ", "bytes are not to be had"};
  expect_says(run("run --source big.avi" + ds), 2, words);
  expect_says(run("run --source drive.avi --reference big.avi" + ds), 2, words);
  EXPECT_FALSE(exists("r.jsonl"));
  expect_says(run("run --source drive.avi --max-places 4000000000" + ds), 2,
              {"max-places: room for 4000000000 places is asked for", "are not to be had"});
  expect_says(run("run --source big.avi --max-places 60" + ds), 0,
              {"ended after 50 of the 2147483648 frames"});
}

TEST_F(DriveFaults, AVideoThatPromisesTooLittleIsReadToItsEnd) {
  std::string bytes = video();
  set_number(bytes, bytes.find("avih") + 8 + 16, 3);
  set_number(bytes, bytes.find("strh") + 8 + 32, 3);
  folder_.write("drive.avi", bytes);
  const test::Outcome alone = run("run --source drive.avi --ds 4 --exclude 10 --out r.jsonl");
  expect_says(alone, 0, {});
  EXPECT_EQ(alone.err.find("the map was full"), std::string::npos) << alone.err;
  EXPECT_EQ(lines("r.jsonl").size(), 50U);
  expect_says(run("run --source drive.avi --reference drive.avi --ds 4 --out r.jsonl"), 0, {});
  EXPECT_EQ(lines("r.jsonl").size(), 50U);
}

// Whoever looks at whole pictures, such as `stills`, reads as far as whoever describes them.
TEST_F(DriveFaults, APictureThatIsNoneEndsNoVideo) {
  std::string bytes = video();
  std::size_t chunk = bytes.find("movi");
  for (int i = 0; i <= 7; ++i) chunk = bytes.find("00dc", chunk + 4);
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(chunk) + 8,
            bytes.begin() + static_cast<std::ptrdiff_t>(bytes.find("00dc", chunk + 4)), '\0');
  folder_.write("drive.avi", bytes);
  const std::string fault = "frame 7: the frame is no JPEG picture";
  expect_says(run("stills --source drive.avi --out stills"), 0,
              {fault, "50 stills", "empty files: 1 unreadable frame\n"});
  EXPECT_EQ(std::filesystem::file_size(file("stills/000007.png")), 0U);
  EXPECT_GT(std::filesystem::file_size(file("stills/000049.png")), 0U);
  expect_says(run("describe --source drive.avi --out d.npy"), 0,
              {fault, "50 frames", "rows of zeros: 1 unreadable frame\n"});
}

TEST_F(DriveFaults, AVideoWithoutAFrameRateIsRemarkedOn) {
  std::string bytes = video();
  folder_.write("drive.avi", bytes);
  set_number(bytes, bytes.find("avih") + 8, 0);
  set_number(bytes, bytes.find("strh") + 8 + 20 + 4, 0);
  folder_.write("zero.avi", bytes);
  const std::string ds = " --ds 4 --exclude 10 --out r.jsonl";
  const std::string remark = ": the video does not say its frame rate: it is taken for 25";
  expect_says(run("run --source zero.avi" + ds), 0, {"zero.avi" + remark});
  expect_says(run("describe --source zero.avi --out d.npy"), 0, {"zero.avi" + remark});
  const test::Outcome usual = run("run --source drive.avi" + ds);
  expect_says(usual, 0, {});
  EXPECT_EQ(usual.err.find("frame rate"), std::string::npos) << usual.err;
}

}  // namespace
}  // namespace seqloop
