// SPDX-License-Identifier: MIT
// The whole chain on drives that the project makes itself: pictures, truth, answers.
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program/program.hpp"

namespace seqloop {
namespace {

class StreetDrive : public test::Program {
 protected:
  void make(const std::string& arguments) const {
    const std::string command = "'" SEQLOOP_STREET_BINARY "' --quiet --size 160x90 --out '" +
                                file("drive") + "' " + arguments;
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }

  nlohmann::json measures(const std::string& tolerance) const {
    const auto evaluated =
        run("eval --json --matches m.csv --truth drive/truth.csv --tolerance " + tolerance);
    EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
    std::printf("%s", evaluated.out.c_str());
    return nlohmann::json::parse(evaluated.out);
  }
};

TEST_F(StreetDrive, ItsProgramTellsItsVersionAndWhereHelpIs) {
  const test::Outcome version = run("--version; '" SEQLOOP_STREET_BINARY "' --version");
  EXPECT_EQ(version.exit_code, 0) << version.err;
  EXPECT_NE(version.out.find("seqloop-street "), std::string::npos) << version.out;
  const test::Outcome wrong = run("--version; '" SEQLOOP_STREET_BINARY "' --wrong");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("--wrong; see seqloop-street --help"), std::string::npos) << wrong.err;
}

TEST_F(StreetDrive, IsLocalisedInAnotherSeason) {
  make("--frames 300 --drives localise");
  for (const std::string drive : {"reference", "query"}) {
    ASSERT_EQ(run("describe --source drive/" + drive + " --out " + drive + ".npy").exit_code, 0);
  }
  ASSERT_EQ(run("match --method seqcnnslam --reference reference.npy --query query.npy --out m.csv")
                .exit_code,
            0);
  EXPECT_GT(measures("3")["recall"].get<double>(), 0.7);
}

TEST_F(StreetDrive, ClosesItsLoopsAsAVideoAndShowsThem) {
  make("--frames 500 --drives loop --format avi --seed 2");
  const auto outcome = run("run --source drive/drive.avi --out r.jsonl --pictures pics");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("damaged"), std::string::npos) << outcome.err;
  std::istringstream text(test::read_all(file("r.jsonl")));
  std::size_t frames = 0;
  std::size_t matches = 0;
  for (std::string line; std::getline(text, line); ++frames) {
    const auto json = nlohmann::json::parse(line);
    for (const auto& answer : json["answers"]) {
      matches += answer["status"] == "match" ? 1U : 0U;
    }
  }
  EXPECT_EQ(frames, 500U);
  EXPECT_GT(matches, 150U) << "of 323; a drive of 500 frames is soon over";
  for (const char* picture : {"pics/difference_matrix.png", "pics/matches.png"}) {
    EXPECT_TRUE(test::read_all(file(picture)).starts_with("\x89PNG")) << picture;
  }
}

TEST_F(StreetDrive, SurvivesDamageInTheMiddle) {
  make("--frames 120 --drives localise");
  const std::string cut = file("drive/query/000040.jpg");
  ASSERT_TRUE(std::filesystem::exists(cut)) << listing();
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  folder_.write("drive/query/000041.jpg", "");
  folder_.write("drive/query/notes.txt", "not a picture");
  const auto outcome =
      run("run --source drive/query --reference drive/reference --method seqcnnslam --ds 10 "
          "--out r.jsonl");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* word : {"000040.jpg", "000041.jpg", "notes.txt", "2 frame_error"}) {
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
  }
  std::istringstream text(test::read_all(file("r.jsonl")));
  std::size_t frame = 0;
  for (std::string line; std::getline(text, line); ++frame) {
    const auto json = nlohmann::json::parse(line);
    const bool bad = frame == 40 || frame == 41;
    EXPECT_EQ(json["status"] == "frame_error", bad) << line;
    EXPECT_EQ(json.contains("fault"), bad);
  }
  EXPECT_EQ(frame, 120U);

  // What is described first and matched then gets the same answers.
  for (const std::string drive : {"reference", "query"}) {
    ASSERT_EQ(run("describe --source drive/" + drive + " --out " + drive + ".npy").exit_code, 0);
  }
  ASSERT_EQ(run("match --method seqcnnslam --ds 10 --reference reference.npy --query query.npy "
                "--out m.csv")
                .exit_code,
            0);
  std::istringstream again(test::read_all(file("r.jsonl")));
  std::map<std::size_t, std::string> matches;  // of frames: sure ones overtake others
  for (std::string line; std::getline(again, line);) {
    const auto json = nlohmann::json::parse(line);
    for (const auto& answer : json["answers"]) {
      if (!answer["match"].is_null()) matches[answer["frame"]] = answer["match"].dump();
    }
  }
  std::string answers = "query,match\n";
  for (const auto& [number, place] : matches) {
    answers += std::to_string(number) + ',' + place + '\n';
  }
  std::istringstream list(test::read_all(file("m.csv")));
  std::string matched;
  for (std::string line; std::getline(list, line);) {
    matched += line.substr(0, line.find(',', line.find(',') + 1)) + '\n';
  }
  EXPECT_EQ(matched, answers);
}

TEST_F(StreetDrive, BlackFramesMatchNothing) {
  make("--frames 120 --drives localise --format png");
  const auto blacken = [&](const std::string& drive, int first) {
    for (int frame = first; frame < first + 8; ++frame) {
      const std::string number = std::to_string(1'000'000 + frame).substr(1);
      const std::string name = "drive/" + drive + '/' + number;
      ASSERT_TRUE(std::filesystem::remove(file(name + ".png")));
      folder_.write(name + ".pgm", std::string("P5 160 90 255\n").append(160U * 90U, '\0'));
    }
  };
  blacken("reference", 20);
  blacken("query", 80);
  ASSERT_EQ(run("run --source drive/query --reference drive/reference --method seqcnnslam --ds 6 "
                "--out r.jsonl")
                .exit_code,
            0);
  std::istringstream text(test::read_all(file("r.jsonl")));
  std::size_t errors = 0;
  for (std::string line; std::getline(text, line);) {
    const auto json = nlohmann::json::parse(line);
    errors += json["status"] == "frame_error" ? 1U : 0U;
    if (json["status"] != "match") continue;
    const auto frame = json["frame"].get<int>();
    const auto place = json["match"].get<int>();
    EXPECT_FALSE(frame >= 75 && frame <= 92 && place >= 15 && place <= 32) << line;
  }
  EXPECT_EQ(errors, 8U);
}

}  // namespace
}  // namespace seqloop
