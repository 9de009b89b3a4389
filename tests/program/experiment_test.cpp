// SPDX-License-Identifier: MIT
// Whole experiments through the real binary: their numbers against those of the single verbs, what
// is done again and what is not, and what can be wrong with them.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>

#include "evaluation/csv.hpp"
#include "platform/pictures.hpp"
#include "program/program.hpp"

namespace seqloop {
namespace {

class Experiments : public test::Program {
 protected:
  void SetUp() override {
    make_drive("a", 40, 0);
    make_drive("b", 40, 1);
    make_drive("short", 6, 0);
  }

  /// Frame i of all drives shows the same place, a little moved.
  void make_drive(const std::string& name, int frames, int moved) const {
    std::filesystem::create_directory(file(name));
    for (int i = 0; i < frames; ++i) {
      const cv::Mat place = test::textured(64 + 8, 32, static_cast<std::uint64_t>(i) / 2 + 1);
      folder_.write(fmt::format("{}/{}.png", name, i),
                    test::encoded(place(cv::Rect(moved + i % 2 * 3, 0, 64, 32)).clone(), ".png"));
    }
  }

  /// The same as a motion JPEG whose header declares so many frames.
  void make_video(const std::string& name, const std::string& drive, int frames,
                  std::uint32_t declared) const {
    {
      cv::VideoWriter writer(file(name), cv::CAP_OPENCV_MJPEG,
                             cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0, cv::Size(64, 32));
      for (int i = 0; i < frames; ++i) {
        writer.write(cv::imread(file(fmt::format("{}/{}.png", drive, i))));
      }
    }
    std::string bytes = test::read_all(file(name));
    for (const std::size_t place : {bytes.find("avih") + 8 + 16, bytes.find("strh") + 8 + 32}) {
      for (std::size_t i = 0; i < 4; ++i)
        bytes.at(place + i) = static_cast<char>(declared >> 8 * i);
    }
    folder_.write(name, bytes);
  }

  static constexpr const char* drives = R"(
[[drive]]
name = "first"
source = "a"
[[drive]]
name = "second"
source = "b"
[[descriptor]]
name = "gradients"
[[descriptor]]
name = "patches"
descriptor = "patches"
)";
  static constexpr const char* pair = R"(
[[pair]]
name = "both"
reference = "first"
query = "second"
tolerance = 1
)";
  static constexpr const char* methods = R"(
[[method]]
name = "ours"
method = "seqcnnslam"
descriptor = "gradients"
ds = [4, 8]
[[method]]
name = "ranges"
method = "a-seqcnnslam"
paper = true
descriptor = "gradients"
ds = 4
k = [2, 3]
[[method]]
name = "theirs"
method = "seqslam"
descriptor = "patches"
ds = 4
[[figure]]
title = "Curves"
panel = "ds"
[[table]]
title = "Numbers"
rows = ["method"]
columns = ["ds"]
values = ["recall_at_100_precision"]
)";

  void write_experiment(const std::string& text) const { folder_.write("e.toml", text); }

  [[nodiscard]] test::Outcome run_it() const { return run("eval --experiment e.toml --out out"); }

  test::Outcome expect_done() const {
    test::Outcome outcome = run_it();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }

  void expect_refused(const std::vector<std::string>& words) const {
    const test::Outcome outcome = run_it();
    EXPECT_EQ(outcome.exit_code, 2);
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
    EXPECT_FALSE(exists("out")) << "no work before the faults are told";
  }

  /// The row of results.csv of a method with these settings.
  [[nodiscard]] std::size_t row_of(const evaluation::CsvTable& table, const std::string& method,
                                   double ds, double k) const {
    const std::string text = test::read_all(file("out/results.csv"));
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    for (std::size_t row = 0; std::getline(lines, line); ++row) {
      if (!line.starts_with("both," + method + ',')) continue;
      if (table.number(row, table.column("ds")) != ds) continue;
      if (k == 0.0 || table.number(row, table.column("k")) == k) return row;
    }
    ADD_FAILURE() << "no row of " << method;
    return 0;
  }

  void expect_like_the_verbs(const std::string& method, const std::string& descriptor,
                             const std::string& flags, double ds, double k = 0.0) const {
    SCOPED_TRACE(flags);
    for (const std::string drive : {"a", "b"}) {
      ASSERT_EQ(run(fmt::format("describe --source {0} --out {0}.npy --descriptor {1}", drive,
                                descriptor))
                    .exit_code,
                0);
    }
    ASSERT_EQ(run("match --reference a.npy --query b.npy --out m.csv " + flags).exit_code, 0);
    const auto wanted =
        nlohmann::json::parse(run("eval --matches m.csv --frames 40 --tolerance 1 --json").out);
    const auto table = evaluation::CsvTable::read(file("out/results.csv"));
    const std::size_t row = row_of(table, method, ds, k);
    for (const char* name : {"answered", "correct", "precision", "recall",
                             "recall_at_100_precision", "area_under_curve"}) {
      EXPECT_NEAR(table.number(row, table.column(name)), wanted[name].get<double>(), 1e-8) << name;
    }
    EXPECT_GT(table.number(row, table.column("answered")), 0.0);
  }
};

TEST_F(Experiments, SayWhatDescribeMatchAndEvalSay) {
  write_experiment(std::string(drives) + pair + methods);
  const auto outcome = expect_done();
  EXPECT_NE(outcome.err.find("matching 5/5"), std::string::npos) << outcome.err;
  for (const std::string name : {"out/index.html", "out/results.csv", "out/figure-1-curves.svg"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
  expect_like_the_verbs("ours", "gradients", "--method seqcnnslam --ds 4", 4);
  expect_like_the_verbs("ours", "gradients", "--method seqcnnslam --ds 8", 8);
  expect_like_the_verbs("ranges", "gradients", "--method a-seqcnnslam --paper --ds 4 --k 3", 4, 3);
  expect_like_the_verbs("theirs", "patches", "--method seqslam --ds 4", 4);
}

/// Numbers over two kinds of threshold stand side by side, and nobody would see it.
TEST_F(Experiments, SayWhatTheirCurvesSweep) {
  write_experiment(std::string(drives) + pair + R"(
[[method]]
name = "by uniqueness"
method = "seqcnnslam"
descriptor = "gradients"
ds = 4
[[method]]
name = "by score"
method = "seqcnnslam"
descriptor = "gradients"
ds = 4
threshold-on = "score"
[[table]]
title = "Numbers"
rows = ["method", "threshold-on"]
values = ["recall_at_100_precision"]
where = { threshold-on = ["score", "uniqueness"] }
)");
  expect_done();
  const std::string results = test::read_all(file("out/results.csv"));
  EXPECT_EQ(results.find("pair,method,descriptor,algorithm,ds,threshold-on,"), 0U) << results;
  EXPECT_NE(results.find("both,by uniqueness,gradients,seqcnnslam,4,uniqueness,"), results.npos)
      << results;
  EXPECT_NE(results.find("both,by score,gradients,seqcnnslam,4,score,"), results.npos) << results;
  EXPECT_NE(test::read_all(file("out/index.html")).find("threshold-on"), std::string::npos);
}

TEST_F(Experiments, SweepNoProbabilityWhereNoneIsSaid) {
  write_experiment("threshold-on = \"probability\"\n" + std::string(drives) + pair + methods);
  const std::string err = run_it().err;
  for (const char* name : {"ranges", "theirs"}) {
    EXPECT_NE(err.find(fmt::format("method '{}': threshold-on: the uniqueness decides", name)),
              std::string::npos)
        << err;
  }
  EXPECT_EQ(err.find("method 'ours'"), std::string::npos) << err;
  EXPECT_FALSE(exists("out"));
}

TEST_F(Experiments, GoOnWhereTheyWere) {
  write_experiment(std::string(drives) + pair + methods);
  // A small limit on file sizes is a disk that is full after the first descriptors.
  const test::Outcome full = run("--version && trap '' XFSZ && ulimit -f 100 && '" SEQLOOP_BINARY
                                 "' eval --experiment e.toml --out out --jobs 1");
  EXPECT_EQ(full.exit_code, 1) << full.err;
  EXPECT_NE(full.err.find("File too large"), std::string::npos) << full.err;
  EXPECT_FALSE(exists("out/index.html"));

  EXPECT_NE(expect_done().err.find("matching 5/5"), std::string::npos);
  const std::string page = test::read_all(file("out/results.csv"));
  EXPECT_EQ(expect_done().err.find("matching"), std::string::npos) << "nothing is left to do";
  EXPECT_EQ(test::read_all(file("out/results.csv")), page);

  const auto elsewhere = run("eval --experiment e.toml --out ./out/../out");
  EXPECT_EQ(elsewhere.err.find("matching"), std::string::npos) << "the folder is the same";

  std::vector<std::filesystem::path> kept;
  for (const auto& entry : std::filesystem::directory_iterator(file("out/runs"))) {
    if (entry.path().extension() == ".json") kept.push_back(entry.path());
  }
  ASSERT_EQ(kept.size(), 5U);
  std::filesystem::remove(kept[0]);
  folder_.write("out/runs/" + kept[1].filename().string(), "{\"pair\": 1}");
  EXPECT_NE(expect_done().err.find("matching 2/2"), std::string::npos);

  // Another first sequence length: another run is shown as a matrix.
  std::string fewer = std::string(drives) + pair + methods;
  fewer.replace(fewer.find("[4, 8]"), 6, "[8, 4]");
  write_experiment(fewer);
  EXPECT_NE(expect_done().err.find("matching 1/1"), std::string::npos);
  EXPECT_TRUE(expect_done().err.find("matching") == std::string::npos);

  make_drive("b", 40, 2);
  const std::string err = expect_done().err;
  EXPECT_NE(err.find("preparing 2/2"), std::string::npos) << "another drive: " << err;
  EXPECT_NE(err.find("matching 5/5"), std::string::npos) << err;
}

TEST_F(Experiments, FillNoFolderThatIsSomebodyElses) {
  write_experiment(std::string(drives) + pair + methods);
  const auto refused = [&](const std::string& folder, const std::string& word) {
    const test::Outcome outcome = run("eval --experiment e.toml --out " + folder);
    EXPECT_EQ(outcome.exit_code, 2) << folder;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists(folder + "/runs"));
  };
  std::filesystem::create_directory(file("site"));
  folder_.write("site/index.html", "<html>mine</html>");
  refused("site", "holds something that no experiment has left");
  EXPECT_EQ(test::read_all(file("site/index.html")), "<html>mine</html>");
  refused("b/../a", "would come among those of b/../a, which is read");
  std::filesystem::create_directory(file("photos"));
  folder_.write("photos/1.png", "a picture of no experiment");
  refused("photos", "holds something that no experiment has left");

  std::filesystem::create_directory(file("out"));
  expect_done();
  EXPECT_EQ(expect_done().exit_code, 0) << "its own report is replaced";
  folder_.write("out/index.html", "<html>mine</html>");
  const test::Outcome outcome = run_it();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(test::read_all(file("out/index.html")), "<html>mine</html>");
}

TEST_F(Experiments, WriteOverNothingThatTheyRead) {
  std::filesystem::create_directories(file("out/runs"));
  std::filesystem::create_directory(file("out/descriptors"));
  folder_.write("out/results.csv", "query,reference\n1,1\n");
  write_experiment(std::string(drives) + pair + "truth = \"out/results.csv\"\n" + methods);
  const test::Outcome outcome = run_it();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("out/results.csv would destroy an input"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(test::read_all(file("out/results.csv")), "query,reference\n1,1\n");
}

TEST_F(Experiments, SayWhatHasNothingToShow) {
  write_experiment(std::string(drives) + pair + methods + "where = { ds = [16, 17] }\n" +
                   "[[figure]]\ntitle = \"Others\"\nwhere = { method = \"others\" }\n");
  const std::string err = expect_done().err;
  EXPECT_NE(err.find("table 'Numbers': nothing to show: no result has ds 16 or 17"),
            std::string::npos)
      << err;
  EXPECT_NE(err.find("figure 'Others': nothing to show"), std::string::npos) << err;
  EXPECT_EQ(err.find("figure 'Curves'"), std::string::npos) << err;
  const std::string page = test::read_all(file("out/index.html"));
  EXPECT_NE(page.find("Table 1. Numbers"), std::string::npos);
  EXPECT_NE(page.find("nothing to show: no result has ds 16 or 17"), std::string::npos);
}

TEST_F(Experiments, MakeDamagedPicturesAnew) {
  write_experiment(std::string(drives) + pair + methods);
  expect_done();
  const std::string page = test::read_all(file("out/index.html"));
  std::vector<std::filesystem::path> pictures;
  for (const auto& entry : std::filesystem::directory_iterator(file("out/runs"))) {
    if (entry.path().extension() == ".png") pictures.push_back(entry.path());
  }
  ASSERT_EQ(pictures.size(), 2U);
  std::string png = test::read_all(pictures[0]);
  png[png.size() / 2] = static_cast<char>(png[png.size() / 2] ^ 1);
  std::ofstream(pictures[0], std::ios::binary) << png;
  std::filesystem::resize_file(pictures[1], png.size() / 3);
  EXPECT_NE(expect_done().err.find("matching 2/2"), std::string::npos);
  const auto matrices = [](const std::string& html) {
    const std::size_t begin = html.find("<h2>Difference matrices");
    return html.substr(begin, html.find("</section>", begin) - begin);
  };
  EXPECT_EQ(matrices(test::read_all(file("out/index.html"))), matrices(page));
  EXPECT_EQ(expect_done().err.find("matching"), std::string::npos);
}

TEST_F(Experiments, RemoveWhatAKilledRunLeft) {
  std::filesystem::create_directories(file("out/runs"));
  std::filesystem::create_directory(file("out/descriptors"));
  folder_.write("out/runs/.both--ours--0123456789abcdef.json.partial-99", "half");
  folder_.write("out/descriptors/.first--gradients--0123456789abcdef.npy.partial-99-1", "half");
  write_experiment(std::string(drives) + pair + methods);
  expect_done();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(file("out"))) {
    EXPECT_EQ(entry.path().string().find("partial"), std::string::npos) << entry.path();
  }
}

TEST_F(Experiments, EveryFaultAtOnceBeforeAnyWork) {
  folder_.write("t.csv", "query,reference\n1,1\n40,3\n2,77\n");
  write_experiment(R"(
titel = "x"
[[drive]]
name = "long"
source = "a"
fps = 0
[[drive]]
name = "first"
source = "a"
[[drive]]
name = "second"
source = "none"
[[descriptor]]
name = "net"
model = "none.onnx"
[[pair]]
name = "wrong truth"
reference = "first"
query = "first"
truth = "t.csv"
[[pair]]
name = "no drive"
reference = "firs"
query = "second"
dark-below = 300
[[method]]
name = "m"
method = "seqcnslam"
descriptor = "nett"
ds = [4, 4, "x"]
best-of = "dss"
[[method]]
name = "n"
method = "seqslam"
descriptor = "net"
ds = 2
[[table]]
title = "t"
rows = "method"
values = "recal"
)");
  expect_refused(
      {"e.toml:2", "did you mean 'title'", "none: ", "none.onnx", "frame 40 of the query",
       "frame 77 of the reference", "there is no [[drive]] 'firs'", "did you mean 'first'",
       "there is no [[descriptor]] 'nett'", "'seqcnslam' is no known method",
       "'ds' must be a whole number", "'net' does not go with it", "did you mean 'recall'",
       "'fps' must be between", "'dss' is no setting", "has 4 twice", "grey levels"});
}

TEST_F(Experiments, FaultsNameTheFileAndItsKeysAndNoFlags) {
  write_experiment(std::string("threshold-on = \"recall\"\n") + drives + std::string(pair) + R"(
radius = 3
[[descriptor]]
name = "words"
descriptor = "words"
topic = "/camera"
[[method]]
name = "m"
method = "o-seqcnnslam"
descriptor = "gradients"
max-uniqueness = 0.9
[[method]]
name = "p"
method = "a-seqcnnslam"
descriptor = "words"
paper = true
patience = 3
[[method]]
name = "none"
descriptor = "gradients"
)");
  const test::Outcome outcome = run("eval --experiment e.toml --jobs 1");
  EXPECT_EQ(outcome.exit_code, 2);
  for (const char* words :
       {"out: not given; --out FOLDER\n", "e.toml:1: 'threshold-on': 'recall' is none of",
        "; 'min-probability', or 'decide-by' uniqueness\n", "under 'paper', and no frame waits; ",
        "'method' seqslam, ", "'reference-positions' R.csv 'query-positions' Q.csv",
        "training: not given; 'training' DRIVE",
        "'topic' chooses nothing in an experiment; give"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << "\n" << outcome.err;
  }
}

TEST_F(Experiments, RefuseDrivesThatAreTooShortOrDoNotBelongTogether) {
  const std::string method =
      "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\n"
      "descriptor = \"gradients\"\nds = [4, 10]\n";
  const std::string third = "[[drive]]\nname = \"third\"\nsource = \"short\"\n";
  write_experiment(drives + third +
                   "[[pair]]\nname = \"p\"\nreference = \"first\"\n"
                   "query = \"third\"\n" +
                   method);
  expect_refused({"cannot belong together in drives of 40 and of 6 frames",
                  "a window of 11 frames is longer than the drive, 6 frames"});
  write_experiment(drives + third + "[[pair]]\nname = \"p\"\nquery = \"first\"\n" + method);
  expect_refused({"closes loops within a drive"});
  write_experiment(drives + std::string("[[pair]]\nname = \"p\"\nquery = \"first\"\n"));
  expect_refused({"closes loops within a drive"});
  write_experiment(drives + std::string(pair) +
                   "[[method]]\nname = \"m\"\ndescriptor = \"gradients\"\n");
  expect_refused({"method 'm': method: not given"});
  write_experiment("");
  expect_refused({"nothing to run"});
  write_experiment("[[drive]\n");
  expect_refused({"not TOML"});
}

TEST_F(Experiments, LeaveOutEverySpanOfAList) {
  std::string text = drives + std::string(pair) +
                     "truth = \"t.csv\"\n"
                     "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\n"
                     "descriptor = \"gradients\"\nds = 4\n";
  const std::string drive = "source = \"b\"\n";
  text.insert(text.find(drive), "leave-out = [\"0-1\", \"2-2.5,3-3.1\", \"spans.csv\"]\n");
  folder_.write("spans.csv", "from_s,to_s\n3.5,3.7\n");
  folder_.write("t.csv", "query,reference\n0,10\n");
  write_experiment(text);
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  EXPECT_EQ(table.whole(0, table.column("queries")), 40U - 10U - 5U - 1U - 2U);
}

// Headers count too few frames where a recording was stopped hard, and too many where a camera left
// some out.
TEST_F(Experiments, CountTheFramesOfAVideoThemselves) {
  for (const std::uint32_t declared : {3U, 60U}) {
    SCOPED_TRACE(declared);
    make_video("b.avi", "b", 40, declared);
    std::string text = drives + std::string(pair) +
                       "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\n"
                       "descriptor = \"gradients\"\nds = 4\n";
    text.replace(text.find("\"b\""), 3, "\"b.avi\"");
    write_experiment(text);
    expect_done();
    const auto table = evaluation::CsvTable::read(file("out/results.csv"));
    EXPECT_EQ(table.whole(0, table.column("queries")), 40U);
    EXPECT_EQ(table.whole(0, table.column("frames")), 40U);
  }
}

// That drives do not belong together is known once a video was read: it is told once, then.
TEST_F(Experiments, RefuseVideosThatTurnOutToBeOfAnotherLength) {
  make_video("b.avi", "b", 30, 40);
  std::string text = drives + std::string(pair) +
                     "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\n"
                     "descriptor = \"gradients\"\nds = 4\n";
  text.replace(text.find("\"b\""), 3, "\"b.avi\"");
  write_experiment(text);
  const test::Outcome outcome = run_it();
  EXPECT_EQ(outcome.exit_code, 2);
  const std::string why = "cannot belong together in drives of 40 and of 30 frames";
  const std::size_t first = outcome.err.find(why);
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(why, first + 1), std::string::npos) << outcome.err;
}

TEST_F(Experiments, DoAgainWhatOtherFilesSayOtherwise) {
  const std::string spans =
      "[[drive]]\nname = \"late\"\nsource = \"a\"\nleave-out = \"spans.csv\"\n";
  std::string places = "frame,x,y\n";
  for (int i = 0; i < 40; ++i) places += fmt::format("{},{},0\n", i, i);
  folder_.write("r.csv", places);
  folder_.write("q.csv", places);
  folder_.write("spans.csv", "from_s,to_s\n0,0.2\n");
  write_experiment(drives + spans + R"(
[[pair]]
name = "placed"
reference = "first"
query = "second"
reference-positions = "r.csv"
query-positions = "q.csv"
radius = 1.5
[[pair]]
name = "late"
reference = "late"
query = "late"
[[method]]
name = "m"
method = "seqcnnslam"
descriptor = "gradients"
ds = 4
)");
  const auto number = [&](std::size_t row, const char* name) {
    const auto table = evaluation::CsvTable::read(file("out/results.csv"));
    return table.whole(row, table.column(name));
  };
  expect_done();
  EXPECT_GT(number(0, "correct"), 20U);
  EXPECT_EQ(number(1, "places"), 38U);
  std::string moved = "frame,x,y\n";
  for (int i = 0; i < 40; ++i) moved += fmt::format("{},{},0\n", i, (i + 20) % 40);
  folder_.write("r.csv", moved);
  folder_.write("spans.csv", "from_s,to_s\n0,0.5\n");
  expect_done();
  EXPECT_LT(number(0, "correct"), 10U);
  EXPECT_EQ(number(1, "places"), 35U);
}

TEST_F(Experiments, KeepRunsOfAnyNameApart) {
  std::string text = drives;
  for (const char* name : {"öü", "ü"}) {
    text +=
        fmt::format("[[pair]]\nname = \"{}\"\nreference = \"first\"\nquery = \"second\"\n", name);
  }
  for (const char* name : {"ä", "äö"}) {
    text += fmt::format(
        "[[method]]\nname = \"{}\"\nmethod = \"seqcnnslam\"\n"
        "descriptor = \"gradients\"\nds = 4\n",
        name);
  }
  write_experiment(text);
  expect_done();
  const std::string results = test::read_all(file("out/results.csv"));
  for (const char* row : {"öü,ä,", "öü,äö,", "\nü,ä,", "\nü,äö,"}) {
    EXPECT_NE(results.find(row), std::string::npos) << row;
  }
}

class DescribedElsewhere : public Experiments {
 protected:
  void SetUp() override {
    Experiments::SetUp();
    std::filesystem::create_directory(file("own"));
    describe("a", "first");
    describe("b", "second");
  }

  void describe(const std::string& source, const std::string& drive,
                const std::string& flags = "") const {
    const test::Outcome done =
        run(fmt::format("describe --source {} --out own/{}.npy {}", source, drive, flags));
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }

  static constexpr const char* own = R"(
[[descriptor]]
name = "own"
described = "own"
)";
  static constexpr const char* method = R"(
[[method]]
name = "m"
method = "seqcnnslam"
descriptor = ["own", "gradients"]
ds = 4
)";
};

TEST_F(DescribedElsewhere, IsComparedLikeAnyOther) {
  write_experiment(drives + std::string(pair) + own + method);
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 2U);
  for (const char* same : {"places", "queries", "descriptor_size", "correct", "precision",
                           "area_under_curve", "distances"}) {
    EXPECT_EQ(table.number(0, table.column(same)), table.number(1, table.column(same))) << same;
  }
  EXPECT_GT(table.number(0, table.column("correct")), 30.0);
  // What is described anew is matched anew.
  describe("short", "second");
  const test::Outcome shorter = run_it();
  EXPECT_EQ(shorter.exit_code, 2);
  EXPECT_NE(shorter.err.find("own/second.npy: it has 6 rows, and drive 'second' has 40 frames"),
            std::string::npos)
      << shorter.err;
  describe("a", "first", "--descriptor patches");
  describe("b", "second", "--descriptor patches");
  expect_done();
  const auto again = evaluation::CsvTable::read(file("out/results.csv"));
  EXPECT_EQ(again.whole(0, again.column("descriptor_size")), 735U);
  EXPECT_EQ(again.whole(1, again.column("descriptor_size")), 2048U);
}

TEST_F(DescribedElsewhere, IsKeptByItsNameAndThePicturesThatItIsOf) {
  const std::string mine = "[[descriptor]]\nname = \"mine\"\ndescribed = \"own\"\n";
  const std::string both =
      "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\ndescriptor = [\"own\", \"mine\"]\nds = "
      "4\n";
  write_experiment(drives + std::string(pair) + "dark-below = 30\n" + own + mine + both);
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 2U);
  EXPECT_NE(test::read_all(file("out/results.csv")).find(",mine,"), std::string::npos);
  EXPECT_NE(test::read_all(file("out/results.csv")).find(",own,"), std::string::npos);
  EXPECT_EQ(table.whole(0, table.column("queries")), 40U);
  for (int i = 20; i < 24; ++i) {
    folder_.write(fmt::format("b/{}.png", i),
                  test::encoded(cv::Mat(32, 64, CV_8UC3, cv::Scalar::all(3)), ".png"));
  }
  expect_done();
  const auto darker = evaluation::CsvTable::read(file("out/results.csv"));
  EXPECT_EQ(darker.whole(0, darker.column("queries")), 36U);
}

TEST_F(DescribedElsewhere, NeedsNoPictures) {
  const std::string no_pictures = "[[drive]]\nname = \"first\"\n[[drive]]\nname = \"second\"\n";
  const std::string alone =
      "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\ndescriptor = \"own\"\nds = 4\n";
  write_experiment(no_pictures + pair + own + alone);
  expect_done();
  EXPECT_EQ(evaluation::CsvTable::read(file("out/results.csv")).rows(), 1U);
  std::filesystem::remove_all(file("out"));
  write_experiment(no_pictures + pair + "dark-below = 3\n" + own + alone);
  expect_refused(
      {"drive 'first' has no source, and pair 'both' wants its pictures; give a source"});
  write_experiment(no_pictures + "[[descriptor]]\nname = \"gradients\"\n" + pair + own + method);
  expect_refused({"drive 'first' has no source, and descriptor 'gradients' wants its pictures",
                  "drive 'second' has no source"});
}

TEST_F(DescribedElsewhere, HasAllItsFaultsTold) {
  describe("b", "second", "--descriptor patches");
  write_experiment(drives + std::string(pair) + own + "model = \"net.onnx\"\n" + method);
  expect_refused(
      {"descriptor 'own' has been described elsewhere; leave out 'described', or all else",
       "735 values in a row of drive 'first', 2048 in one of 'second'"});
  write_experiment(
      "[[drive]]\nname = \"first\"\n[[pair]]\nname = \"p\"\nquery = \"first\"\n"
      "truth = \"no-revisit\"\ndark-below = 3\n" +
      std::string(own) + "[[descriptor]]\nname = \"gradients\"\ndescribed = \"\"\n" +
      "[[descriptor]]\nname = \"none\"\ndescribed = \"nowhere\"\n"
      "[[drive]]\nname = \"idle\"\n[[drive]]\nname = \"set\"\nfps = 3\n" +
      method);
  expect_refused({"leaves frames out, which wants two drives", "'described': its value is empty",
                  "nowhere is no folder", "drive 'idle' has no source\n",
                  "drive 'set' has no source, which the rest is about"});
  folder_.write("own/first.npy", "nothing");
  std::filesystem::remove(file("own/second.npy"));
  write_experiment(drives + std::string(pair) + own + method);
  expect_refused({"own/first.npy: is not a .npy file", "own/second.npy: does not exist"});
}

TEST_F(Experiments, LeaveDarkFramesOutAndSayHowMany) {
  for (int i = 20; i < 24; ++i) {
    folder_.write(fmt::format("a/{}.png", i),
                  test::encoded(cv::Mat(32, 64, CV_8UC3, cv::Scalar::all(3)), ".png"));
  }
  const std::string method =
      "[[method]]\nname = \"m\"\nmethod = \"seqcnnslam\"\ndescriptor = \"gradients\"\nds = 4\n";
  write_experiment(drives + std::string(pair) + "dark-below = 30\n" + method);
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  EXPECT_EQ(table.whole(0, table.column("queries")), 36U);
  EXPECT_EQ(table.whole(0, table.column("frames")), 36U);
  EXPECT_NE(test::read_all(file("out/index.html")).find("4 dark"), std::string::npos);
}

TEST_F(Experiments, CloseLoopsAndRankTheBest) {
  std::string truth = "query,reference\n";
  for (int i = 0; i < 40; ++i) {
    std::filesystem::copy_file(file(fmt::format("b/{}.png", i)),
                               file(fmt::format("a/{}.png", 40 + i)));
    truth += fmt::format("{},{}\n", 40 + i, i);
  }
  folder_.write("t.csv", truth);
  write_experiment(drives + std::string(R"(
[[pair]]
name = "lap"
query = "first"
truth = "t.csv"
[[method]]
name = "m"
method = "seqcnnslam"
descriptor = "gradients"
exclude = 20
ds = [2, 4, 6]
best-of = "ds"
)"));
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 4U) << "three, and the best of them";
  const auto recall = [&](std::size_t row) {
    return table.number(row, table.column("recall_at_100_precision"));
  };
  EXPECT_EQ(recall(3), std::max({recall(0), recall(1), recall(2)}));
  EXPECT_GT(recall(3), 0.5);
  EXPECT_EQ(table.whole(0, table.column("frames")), 40U);
}

TEST_F(Experiments, ListTheBestInTheOrderOfTheFile) {
  write_experiment(std::string(drives) + pair + R"(
[[method]]
name = "m"
method = "a-seqcnnslam"
descriptor = "gradients"
ds = [2, 4]
k = [6, 10]
best-of = "ds"
)");
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 6U) << "four, and the best with each k";
  EXPECT_EQ(table.whole(4, table.column("k")), 6U);
  EXPECT_EQ(table.whole(5, table.column("k")), 10U);
}

/// What the file calls `method` here, results call the algorithm.
TEST_F(Experiments, RankAlgorithms) {
  write_experiment(std::string(drives) + pair + R"(
[[method]]
name = "either"
method = ["seqcnnslam", "a-seqcnnslam"]
descriptor = "gradients"
ds = 4
best-of = "method"
)");
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 3U) << "two, and the best of them";
  EXPECT_NE(test::read_all(file("out/results.csv")).find("both,either (best),"), std::string::npos);
}

TEST_F(Experiments, SeveralQueryDrivesAreMatchedAsOne) {
  write_experiment(drives + std::string(R"(
[[pair]]
name = "there and again"
query = ["first", "second"]
tolerance = 1
[[pair]]
name = "once"
query = "first"
truth = "no-revisit"
[[pair]]
name = "a little is known"
query = ["first", "second"]
truth = "t.csv"
unlisted = "unknown"
[[pair]]
name = "by where it was"
query = ["first", "second"]
query-positions = "laps.csv"
radius = 1.5
[[method]]
name = "m"
method = "seqcnnslam"
descriptor = "gradients"
exclude = 20
ds = 4
[[figure]]
title = "Said"
kind = "reliability"
panel = "pair"
)"));
  folder_.write("t.csv", "query,reference\n50,10\n60,20\n");
  std::string places = "frame,x,y\n";
  for (int i = 0; i < 80; ++i) places += fmt::format("{},{},0\n", i, i % 40);
  folder_.write("laps.csv", places);
  expect_done();
  const auto table = evaluation::CsvTable::read(file("out/results.csv"));
  ASSERT_EQ(table.rows(), 4U);
  const auto number = [&](std::size_t row, const char* name) {
    return table.number(row, table.column(name));
  };
  EXPECT_EQ(number(0, "places"), 80.0);
  EXPECT_EQ(number(0, "frames"), 40.0) << "the second drive's; the first shows each place once";
  EXPECT_GT(number(0, "correct"), 20.0);
  EXPECT_EQ(number(1, "answered"), 0.0) << "nothing comes twice";
  EXPECT_EQ(number(1, "correct"), 0.0);
  EXPECT_EQ(number(2, "frames"), 2.0);
  EXPECT_EQ(number(2, "correct"), 2.0);
  EXPECT_EQ(number(2, "precision"), 1.0);
  EXPECT_EQ(number(2, "unknown"), number(0, "answered") - 2.0);
  for (const char* same : {"frames", "answered", "correct", "recall"}) {
    EXPECT_EQ(number(3, same), number(0, same)) << same;
  }
  EXPECT_TRUE(exists("out/figure-1-said.svg"));
  // What is right is another thing for each of them.
  const std::string page = test::read_all(file("out/index.html"));
  for (const char* words : {"<dt>there and again</dt><dd>first, then second, closing loops; truth: "
                            "identity, within 1 frame</dd>",
                            "<dd>first, closing loops; every answer is wrong</dd>",
                            "truth: t.csv, within 2 frames, or a row's own tolerance; frames "
                            "that it does not list are not judged",
                            "truth: positions, within 1.5 metres</dd>"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

TEST_F(Experiments, RefuseWhatDoesNotGoWithSeveralQueryDrives) {
  write_experiment(drives + std::string(R"(
[[drive]]
name = "third"
source = "short"
[[pair]]
name = "of two lengths"
query = ["first", "third"]
[[pair]]
name = "localise"
reference = ["first", "second"]
query = "first"
[[pair]]
name = "which i"
reference = "first"
query = ["second", "third"]
[[pair]]
name = "listed"
query = ["first", "second"]
unlisted = "unknown"
[[pair]]
name = "near itself"
query = "first"
reference-positions = "r.csv"
query-positions = "r.csv"
[[pair]]
name = "half placed"
reference = "first"
query = "second"
query-positions = "r.csv"
[[method]]
name = "m"
method = "seqcnnslam"
descriptor = "gradients"
threshold-on = "speed"
ds = 2
[[figure]]
title = "F"
kind = "reliable"
)"));
  expect_refused({"'of two lengths': frames i cannot belong together in drives of 40 and of 6",
                  "'reference' is one drive", "pair 'which i' has several query drives",
                  "unlisted: it goes with a truth", "leave reference-positions out",
                  "'half placed' has a reference drive, whose positions", "'speed' is none of",
                  "none of precision-recall, reliability"});
}

}  // namespace
}  // namespace seqloop
