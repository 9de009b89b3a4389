// SPDX-License-Identifier: MIT
// Every descriptor through the real binary: what it writes, and what a user gets wrong.
#include <algorithm>
#include <vector>

#include "program/program.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

class Descriptor : public test::Program {
 protected:
  /// Ten pictures of 160x120 that drift by a few pixels a frame, a flat one, and a torn one.
  void SetUp() override {
    std::filesystem::create_directory(file("drive"));
    for (int index = 0; index < 10; ++index) write_picture(std::to_string(index), index);
    write_picture("10", -1);
    folder_.write("drive/11.pgm", "P5 160 120 255\ntorn");
  }

  /// Blocks of pseudo-random brightness. @param shift pixels; negative: flat
  void write_picture(const std::string& name, int shift) const {
    std::string pixels = "P5 160 120 255\n";
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const auto block = static_cast<unsigned>((x + 3 * shift) / 10 * 97 + y / 10 * 57);
        pixels += static_cast<char>(shift < 0 ? 80U : block * block * 2654435761U >> 24U);
      }
    }
    folder_.write("drive/" + name + ".pgm", pixels);
  }

  files::Matrix described(const std::string& arguments) const {
    const test::Outcome outcome = run("describe --source drive --out d.npy " + arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("rows of zeros: 1 unreadable frame\n"), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("1 frame is blank"), std::string::npos) << outcome.err;
    files::Matrix rows = files::read_npy(file("d.npy"));
    EXPECT_EQ(rows.rows, 12U);
    EXPECT_EQ(squared_norm(rows.row(11)), 0.0);
    std::filesystem::remove(file("d.npy"));
    return rows;
  }

  void expect_refused(const std::string& arguments, const std::vector<std::string>& words) const {
    SCOPED_TRACE(arguments);
    const test::Outcome outcome = run("describe --source drive --out d.npy " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
    EXPECT_FALSE(exists("d.npy"));
    EXPECT_EQ(listing().find("partial"), std::string::npos) << listing();
  }
};

TEST_F(Descriptor, PatchesAreBetween0And255) {
  const files::Matrix rows = described("--descriptor patches");
  ASSERT_EQ(rows.columns, 64U * 32U);
  const auto [least, most] = std::ranges::minmax(rows.row(0));
  EXPECT_GE(least, 0.0F);
  EXPECT_LE(most, 255.0F);
  EXPECT_GT(most, 160.0F);
  EXPECT_TRUE(std::ranges::all_of(rows.row(10), [](float value) { return value == 127.5F; }));
  EXPECT_EQ(described("--descriptor patches --input-size 48x32").columns, 48U * 32U);
}

TEST_F(Descriptor, WordsAreUnitAndTheSameEveryTime) {
  const std::string words = "--descriptor words --training drive,drive --words 40";
  const files::Matrix rows = described(words);
  ASSERT_EQ(rows.columns, 40U);
  EXPECT_NEAR(squared_norm(rows.row(0)), 1.0, 1e-5);
  EXPECT_EQ(squared_norm(rows.row(10)), 0.0);
  EXPECT_EQ(rows.values, described(words).values);
}

TEST_F(Descriptor, ChangeRemovalWorksAroundGradientsAndModels) {
  const files::Matrix plain = described("");
  EXPECT_EQ(described("--descriptor gradients --remove-components 0").values, plain.values);
  const std::string removal = "--training drive --remove-components 2";
  const test::Outcome outcome = run("describe --source drive --out d.npy " + removal);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const files::Matrix removed = files::read_npy(file("d.npy"));
  EXPECT_EQ(removed.columns, plain.columns);
  EXPECT_NEAR(squared_norm(removed.row(0)), 1.0, 1e-5);
  EXPECT_GT(euclidean(removed.row(0).first(720), plain.row(0).first(720)), 0.01F);
  const test::Outcome model = run("describe --source drive --out m.npy --model " SEQLOOP_TEST_DATA
                                  "/gray_chain.onnx --layer conv " +
                                  removal);
  EXPECT_EQ(model.exit_code, 0) << model.err;
  EXPECT_EQ(files::read_npy(file("m.npy")).columns, 32U);
}

TEST_F(Descriptor, RunLearnsToo) {
  const test::Outcome outcome =
      run("run --source drive --ds 3 --exclude 2 --descriptor words --words 30 --training drive");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Descriptor, NothingIsLearnedWhereTheRestIsWrong) {
  const std::string words = " --descriptor words --words 0 --training ";
  for (const std::string verb : {"describe", "run"}) {
    SCOPED_TRACE(verb);
    const std::string all = verb + " --source none --out nowhere/out";
    for (const auto& [training, wrong] :
         {std::pair{"drive", "nowhere/out: "}, {"missing", "missing: "}}) {
      const test::Outcome outcome = run(all + words + training);
      EXPECT_EQ(outcome.exit_code, 2);
      EXPECT_EQ(outcome.err.find("learn"), std::string::npos) << outcome.err;
      for (const std::string said : {"none: does not exist", "nowhere/out: its folder", wrong}) {
        const std::size_t first = outcome.err.find(said);
        EXPECT_NE(first, std::string::npos) << said << " is not in:\n" << outcome.err;
        EXPECT_EQ(outcome.err.find(said, first + 1), std::string::npos) << "twice:\n"
                                                                        << outcome.err;
      }
    }
  }
  const test::Outcome outcome = run("describe --out d.npy");
  EXPECT_NE(outcome.err.find("source: not given"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(".npy file"), std::string::npos) << "it refuses these";
  const std::string run_says = run("run --out lines.jsonl").err;
  EXPECT_NE(run_says.find("source: not given; give a camera, "), std::string::npos) << run_says;
}

TEST_F(Descriptor, BadInput) {
  expect_refused("--descriptor patchs", {"did you mean 'patches'?"});
  expect_refused("--descriptor fabmap", {"'fabmap'", "gradients, patches or words"});
  expect_refused("--descriptor words --model none.onnx", {"descriptor: a model is given", "none"});
  expect_refused("--descriptor patches --input-size 60x32", {"60x32", "multiples of 8"});
  expect_refused("--descriptor patches --layer x --mean 1,2,3", {"layer: ", "mean: "});
  expect_refused("--descriptor words --training drive --input-size 64x32", {"input-size: "});
  expect_refused("--descriptor words", {"training: not given"});
  expect_refused("--remove-components 3", {"training: not given"});
  expect_refused("--training drive", {"training: nothing is learned from it"});
  expect_refused("--words 5", {"words: there is no vocabulary"});
  expect_refused("--descriptor patches --remove-components 3 --training drive",
                 {"remove-components: ", "patches have none"});
  expect_refused("--descriptor words --words 20001 --training drive", {"20001 is more than 20000"});
  expect_refused("--descriptor words --words 20000 --training drive", {"words: 20000", "11"});
  expect_refused("--descriptor words --words 0 --training drive", {"words: 0"});
  EXPECT_EQ(run("describe --source drive --out d.npy --descriptor words --words 0 --training drive")
                .err.find("learning"),
            std::string::npos);
  expect_refused("--remove-components 11 --training drive",
                 {"11 pictures that can be read and 1 that cannot", "fewer"});
  expect_refused("--remove-components -1 --training drive,,drive", {"'-1'", "no name"});
  folder_.write("old.npy", "");
  expect_refused("--remove-components 1 --training none,old.npy,drive",
                 {"none: does not exist", "old.npy holds descriptors"});
}

TEST_F(Descriptor, EveryFaultAtOnce) {
  expect_refused(
      "--descriptor patches --words 3 --layer x --input-size 3x8 --training none "
      "--remove-components 2",
      {"words: ", "layer: ", "3x8", "none: ", "remove-components: "});
}

TEST_F(Descriptor, TrainingPicturesAreInputsThatNoOutputDestroys) {
  const std::string good = test::read_all(file("drive/3.pgm"));
  std::filesystem::create_directory(file("others"));
  std::filesystem::copy_file(file("drive/3.pgm"), file("others/3.pgm"));
  const std::string training = " --out others/3.pgm --remove-components 1 --training drive,others";
  for (const std::string verb : {"describe --source drive", "run --source drive --ds 3"}) {
    const test::Outcome outcome = run(verb + training);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("destroy an input"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(test::read_all(file("others/3.pgm")), good);
}

}  // namespace
}  // namespace seqloop
