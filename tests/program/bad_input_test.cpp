// SPDX-License-Identifier: MIT
// What a user gets wrong: each is exit code 2, a line that says what, why and what to do, and no
// output file.
#include <cmath>
#include <limits>

#include "core/oracle.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

class BadInput : public test::Program {
 protected:
  void SetUp() override {
    write_npy("good.npy", oracle::drive(1, 60, 12));
    write_npy("wide.npy", oracle::drive(1, 60, 13));
    write_npy("short.npy", oracle::drive(1, 10, 12));
  }

  void write_npy(const std::string& name, const oracle::Vectors& rows) const {
    files::NpyWriter writer(file(name), rows.front().size());
    for (const auto& row : rows) writer.append(row);
    writer.commit();
  }

  /// A NumPy file with a header of one's own.
  void write_raw_npy(const std::string& name, const std::string& header,
                     const std::string& data) const {
    std::string padded = header;
    padded.resize(117, ' ');
    padded += '\n';
    folder_.write(name, std::string("\x93NUMPY\x01\x00", 8) + '\x76' + '\0' + padded + data);
  }

  void expect_refused(const std::string& arguments, const std::vector<std::string>& words) const {
    SCOPED_TRACE(arguments);
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << "no '" << word << "' in:\n"
                                                           << outcome.err;
    }
    EXPECT_TRUE(outcome.err.starts_with("seqloop: ")) << outcome.err;
    EXPECT_FALSE(exists("m.csv"));
    EXPECT_FALSE(exists("d.npy"));
    EXPECT_EQ(listing().find("partial"), std::string::npos) << listing();
  }

  void expect_match_refused(const std::string& arguments,
                            const std::vector<std::string>& words) const {
    expect_refused("match --method seqcnnslam --out m.csv " + arguments, words);
  }
};

TEST_F(BadInput, NpyFiles) {
  const std::string q = "--reference good.npy --query ";
  expect_match_refused(q + "none.npy", {"none.npy"});
  folder_.write("text.npy", "not numbers");
  expect_match_refused(q + "text.npy", {"text.npy", ".npy"});
  std::string good = test::read_all(file("good.npy"));
  folder_.write("cut.npy", std::string_view(good).substr(0, good.size() - 5));
  expect_match_refused(q + "cut.npy", {"cut.npy"});
  write_raw_npy("double.npy", "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }",
                std::string(16, '\0'));
  expect_match_refused(q + "double.npy", {"<f8", "float32"});
  write_raw_npy("fortran.npy", "{'descr': '<f4', 'fortran_order': True, 'shape': (1, 2), }",
                std::string(8, '\0'));
  expect_match_refused(q + "fortran.npy", {"ortran"});
  write_raw_npy("empty.npy", "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 2), }", "");
  expect_match_refused(q + "empty.npy", {"empty.npy"});
  write_raw_npy("flat.npy", "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }",
                std::string(8, '\0'));
  expect_match_refused(q + "flat.npy", {"flat.npy"});
  oracle::Vectors broken = oracle::drive(1, 60, 12);
  broken[17][5] = std::numeric_limits<float>::quiet_NaN();
  write_npy("nan.npy", broken);
  expect_match_refused(q + "nan.npy", {"nan.npy", "17", "5"});
  expect_match_refused(q + "wide.npy", {"12", "13", "same model"});
  expect_match_refused("--reference none.npy --query also-none.npy", {"none.npy", "also-none.npy"});
}

TEST_F(BadInput, Numbers) {
  const std::string drives = "--reference good.npy --query good.npy ";
  expect_match_refused(drives + "--ds 0", {"ds: 0"});
  expect_match_refused(drives + "--ds 60", {"ds", "61", "60"});
  expect_match_refused("--reference good.npy --query short.npy", {"ds", "21", "10"});
  expect_match_refused("--reference short.npy --query good.npy", {"ds", "17", "10"});
  expect_match_refused("--query good.npy --exclude 60", {"exclude", "60"});
  expect_refused("plan --close-loops --exclude 1000001",
                 {"exclude: 1000001 is not between 1 and 1000000"});
  expect_refused(
      "plan --close-loops --full-map thin --max-places 10 --fleet-places 2000000",
      {"max-places: 10 leave no candidates", "with this exclude and ds", "fleet-places"});
  EXPECT_EQ(run("plan --exclude 1000000000").exit_code, 0) << "localising, nothing is remembered";
  expect_match_refused(drives + "--vmin 1.3", {"vmin", "1.3", "vmax", "1.2"});
  expect_match_refused(drives + "--ds 10 --vmin 1.01 --vmax 1.02", {"velocity", "widen"});
  expect_match_refused(drives + "--k 0", {"k: 0"});
  expect_match_refused(drives + "--num 0", {"num: 0"});
  expect_match_refused(drives + "--ds abc", {"ds", "'abc'"});
  expect_match_refused(drives + "--ds -3", {"ds", "'-3'"});
  expect_match_refused(drives + "--vmin nan", {"vmin", "'nan'"});
  expect_match_refused(drives + "--standardise maybe", {"standardise", "'maybe'", "on"});
  expect_refused("match --method a-seqcnslam --out m.csv " + drives,
                 {"did you mean 'a-seqcnnslam'"});
  expect_refused("match --method oseqcnnslam --out m.csv " + drives,
                 {"did you mean 'o-seqcnnslam'"});
  expect_match_refused(drives + "other", {"other: stands after no flag"});
  expect_match_refused(drives + "--enhance on --rwindow 1", {"rwindow: 1", "enhance"});
  expect_match_refused("--query good.npy --ds 4 --enhance on --exclude 5",
                       {"exclude: 5", "rwindow"});
}

TEST_F(BadInput, WhatDecides) {
  const std::string drives = "--reference good.npy --query good.npy ";
  for (const std::string wrong : {"0", "-1", "1.5", "2", "1e-60"}) {
    expect_match_refused(drives + "--min-probability " + wrong,
                         {"min-probability", "above 0 and at most 1"});
  }
  expect_match_refused(drives + "--min-probability nan", {"min-probability", "'nan'"});
  expect_match_refused(drives + "--patience 1001", {"patience: 1001", "1000"});
  expect_match_refused(drives + "--patience -1", {"patience", "'-1'"});
  expect_refused("match --out m.csv " + drives + "--max-uniqueness 0.9",
                 {"max-uniqueness", "probability", "--decide-by uniqueness"});
  expect_match_refused(drives + "--decide-by luck", {"decide-by", "'luck'"});
}

TEST_F(BadInput, ADefaultThatIsWrittenOutDecidesNothing) {
  const std::string drives = " --out m.csv --reference good.npy --query good.npy ";
  const std::string no_probability = "no probability was measured of such differences";
  for (const std::string how : {"--method seqslam", "--difference mean-absolute", "--enhance on"}) {
    expect_refused("match " + how + drives + "--patience 120",
                   {"patience: the uniqueness decides: " + no_probability + ", and no frame waits",
                    "--max-uniqueness, or --decide-by probability"});
    expect_refused("match " + how + drives + "--min-probability .99",
                   {"min-probability: the uniqueness decides: " + no_probability});
  }
  expect_refused("match --paper" + drives + "--patience 120 --min-probability .99",
                 {"patience: the uniqueness decides under --paper", "min-probability: "});
  expect_refused("match --decide-by uniqueness" + drives + "--patience 120",
                 {"patience: the uniqueness decides, and no frame waits"});
  const auto list = [&](const std::string& flags) {
    const test::Outcome outcome = run("match" + drives + flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return test::read_all(file("m.csv"));
  };
  for (const std::string how : {"", "--method seqslam --decide-by probability "}) {
    const std::string wanted = list(how);
    EXPECT_EQ(list(how + "--patience 120"), wanted);
    EXPECT_EQ(list(how + "--min-probability .99"), wanted);
  }
}

TEST_F(BadInput, DrivesThatSayNothingAreAnsweredAndNotAccepted) {
  constexpr std::size_t size = 12;
  write_npy("one.npy", oracle::drive(1, 1, size));
  expect_match_refused("--reference good.npy --query one.npy", {"ds", "21", "1 frames"});
  EXPECT_EQ(run("match --reference good.npy --query one.npy --method single --out m.csv").exit_code,
            0);
  write_npy("black.npy", oracle::Vectors(150, std::vector<float>(size)));
  write_npy(
      "constant.npy",
      oracle::Vectors(150, std::vector<float>(size, 1.0F / std::sqrt(static_cast<float>(size)))));
  for (const std::string drive : {"black", "constant"}) {
    const std::vector<std::string> ways{" --reference good.npy", " --reference " + drive + ".npy",
                                        " --exclude 30"};
    for (const std::string& how : ways) {
      SCOPED_TRACE(drive + how);
      const test::Outcome matched = run("match --query " + drive + ".npy --out m.csv" + how);
      EXPECT_EQ(matched.exit_code, 0) << matched.err;
      EXPECT_EQ(test::read_all(file("m.csv")).find(",1\n"), std::string::npos);
      const test::Outcome outcome = run("run --source " + drive + ".npy --out r.jsonl" + how);
      // Nothing can be read of a drive that is black from end to end.
      EXPECT_EQ(outcome.exit_code, drive == "black" ? 2 : 0) << outcome.err;
      if (drive == "black") continue;
      EXPECT_EQ(test::read_all(file("r.jsonl")).find("\"status\":\"match\""), std::string::npos);
    }
  }
}

TEST_F(BadInput, WhatIsWrongIsToldOnce) {
  std::filesystem::create_directory(file("folder"));
  folder_.write("gaps.csv", "from,to\n0,1\n");
  const std::string drive = "run --source good.npy --out r.jsonl --exclude 20 ";
  for (const auto& [arguments, said] : {
           std::pair{drive + "--fps 0", "fps: a frame rate is between 0.001 and 1000000\n"},
           {drive + "--realtime-priority 300", "realtime-priority: it must be 0 to 98\n"},
           {"describe --source good.npy --out d.npy --remove-components 5000 --training folder",
            "remove-components: 5000 is more than 999\n"},
           {"stills --source good.npy --out d --leave-out gaps.csv",
            "leave-out: gaps.csv: no column 'from_s' in its header line; its columns are from, to\n"
            "seqloop: leave-out: gaps.csv: no column 'to_s' in its header line; its columns are "
            "from, to\n"},
       }) {
    expect_refused(arguments, {said});
    const std::string err = run(arguments).err;
    for (const char* again : {"frame rate: ", "real-time", "nothing is learned"}) {
      EXPECT_EQ(err.find(again), std::string::npos) << err;
    }
  }
}

TEST_F(BadInput, EveryFaultAtOnce) {
  expect_match_refused(
      "--reference none.npy --query good.npy --ds 0 --k 0 --vmin 2 --num x --what 1",
      {"none.npy", "ds: 0", "k: 0", "num: 'x'", "--what"});
  const test::Outcome outcome = run("match");
  EXPECT_EQ(outcome.exit_code, 2);
  for (const char* flag : {"--query", "--out"}) {
    EXPECT_NE(outcome.err.find(flag), std::string::npos) << outcome.err;
  }
}

TEST_F(BadInput, FaultsOfInputsAreToldBesideThoseOfOutputs) {
  folder_.write("poses.tum", "0 1 2\n");
  expect_refused(
      "run --source none --out no/r.jsonl --pictures good.npy/p --pose-graph no/g.g2o --odometry "
      "poses.tum --map no/m.seqloop",
      {"none: does not exist", "no/r.jsonl: its folder", "good.npy/p: ", "no/g.g2o: its folder",
       "poses.tum: line 1 is no pose", "no/m.seqloop: its folder does not exist; create "});
  expect_refused("run --source none --pose-graph g.g2o --odometry " + file("poses.tum"),
                 {"none: does not exist", "poses.tum: line 1 is no pose"});
  expect_refused("run --source good.npy --out no/r.jsonl --map none.seqloop --read-only",
                 {"no/r.jsonl: ", "none.seqloop: there is no such map"});
  expect_refused("report none.jsonl --summary none.json --out no/p.html",
                 {"none.jsonl: cannot be read: No such file or directory; name what `seqloop run",
                  "none.json: cannot be read: No such file or directory; name what `seqloop run",
                  "no/p.html: its folder"});
  folder_.write("no.json", "{}");
  expect_refused("report good.npy/ --summary no.json --out no/p.html",
                 {"good.npy/: cannot be read: Not a directory", "no.json is not what", "give the"});
}

TEST_F(BadInput, OddAndSmallestSequenceLengthsWork) {
  for (const char* ds : {"1", "2", "3", "59"}) {
    const test::Outcome outcome =
        run(std::string("match --method seqcnnslam --reference good.npy --query good.npy "
                        "--out m.csv --ds ") +
            ds);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
}

TEST_F(BadInput, ConfigurationFiles) {
  const std::string match = "--reference good.npy --query good.npy --config c.toml ";
  folder_.write("c.toml", "initial_k = 5\nds = \"twenty\"\nvmin = 5.0\n[budget]\ntotals = 3\n");
  expect_match_refused(match, {"c.toml:1", "'initial_k'", "did you mean 'initial-k'", "c.toml:2",
                               "'ds' must be a whole number, not string", "c.toml:5",
                               "'budget-totals'", "did you mean 'budget-total'"});
  folder_.write("c.toml", "vmin = 5.0\nk = 0\n");
  expect_match_refused(match, {"vmin: 5", "k: 0"});
  folder_.write("c.toml", "budget-total = 30\n[budget]\ntotal = 40\n");
  expect_refused("run --source good.npy --config c.toml",
                 {"c.toml:3", "'budget.total'", "'budget-total'", "c.toml:1"});
  // What is a flag of another verb is none as a table.
  folder_.write("c.toml", "[run]\nds = 40\n[source]\nds = 4\n");
  expect_refused("run --source good.npy --config c.toml",
                 {"c.toml:2", "'run-ds' is no known key", "c.toml:4", "'source-ds'"});
  folder_.write("c.toml", "ds = [1\n");
  expect_match_refused(match, {"c.toml:", "not TOML"});
  folder_.write("c.toml", "ds = 2.5\nstandardise = 3\npaper = \"yes\"\nmethod = 1\n");
  expect_match_refused(match, {"'ds'", "'standardise'", "'paper'", "'method'"});
  expect_match_refused("--reference good.npy --query good.npy --config none.toml", {"none.toml"});
}

TEST_F(BadInput, CommandLines) {
  expect_refused("run --source good.npy --standardise", {"--standardise: 1 required"});
  expect_refused("", {"subcommand"});
  expect_refused("fly", {"fly"});
  expect_refused("match --quer good.npy", {"did you mean --query"});
  expect_refused("match --ds", {"ds"});
  expect_refused("match --ds 10 --ds 20", {"ds: given more than once"});
  folder_.write("c.toml", "");
  expect_refused("match --config c.toml --config c.toml",
                 {"config: given more than once", "query"});
  expect_match_refused(
      "--reference good.npy --query good.npy --paper=maybe --read-only=1",
      {"paper: 'maybe' is neither true nor false", "read-only: '1' is neither true nor false"});
  expect_match_refused("--reference good.npy --query good.npy --paper --paper=false",
                       {"paper: given more than once"});

  expect_refused("match --hepl", {"did you mean --help"});
  folder_.write("no.seqloop", "places");
  for (const char* verb : {"run --source none", "match --query none"}) {
    expect_refused(std::string(verb) + " --map no.seqloop --out m", {"none", "no SeqLoop map"});
  }
  folder_.write("a.jsonl", "{}\n");
  folder_.write("b.jsonl", "{}\n");
  for (const char* two : {"a.jsonl b.jsonl", "--run a.jsonl b.jsonl", "a.jsonl --run b.jsonl"}) {
    expect_refused("report " + std::string(two) + " --out p.html", {"more than one run is given"});
  }
  expect_refused("plan --max-places 0", {"places"});
  expect_refused("plan --max-places 10 --descriptor-size 131073",
                 {"descriptor-size: 131073", "--arithmetic float", "--relocalise off",
                  "--decide-by uniqueness"});
}

TEST_F(BadInput, EmptyValues) {
  const auto refused = [&](const std::string& words, const std::string& name) {
    expect_refused(words, {name + ": its value is empty; give one, or leave it out\n"});
  };
  for (const char* name : {"reference", "map", "out", "summary", "pictures", "out-bag", "odometry",
                           "session", "topic", "method", "config"}) {
    refused("run --source good.npy --" + std::string(name) + " ''", name);
    // What follows is no value of it.
    refused("run --source good.npy --" + std::string(name) + "= --paper", name);
  }
  refused("match --query good.npy --out ''", "out");
  refused("eval --matches '' --truth identity", "matches");
  folder_.write("c.toml", "reference = \"\"\n");
  refused("run --source good.npy --config c.toml", "c.toml:1: 'reference'");
}

TEST_F(BadInput, Sources) {
  std::filesystem::create_directory(file("empty"));
  folder_.write("noise.mp4", "this is no video");
  folder_.write("empty.mp4", "");
  const std::string describe = "describe --out d.npy --source ";
  expect_refused(describe + "none", {"none"});
  expect_refused("run --source 0",
                 {"0: does not exist; if it is the number of a camera, name /dev/video0"});
  expect_refused(describe + "empty", {"empty"});
  expect_refused(describe + "noise.mp4", {"noise.mp4"});
  expect_refused(describe + "empty.mp4", {"empty.mp4"});
  expect_refused(describe + "good.npy", {"good.npy", "image folder"});
  expect_refused("run --source none --reference empty --ds 0 --model none.onnx",
                 {"none:", "empty", "ds: 0", "none.onnx"});
  expect_refused("run --source good.npy --reference wide.npy", {"13", "12"});
  expect_refused("run --source good.npy --reference good.npy --budget-total 0", {"budget-total"});
}

TEST_F(BadInput, Models) {
  std::filesystem::create_directory(file("drive"));
  std::filesystem::copy_file(SEQLOOP_TEST_DATA "/gray_chain.onnx", file("model.onnx"));
  folder_.write("noise.onnx", "this is no model");
  folder_.write("drive/0.pgm", std::string("P5 4 4 255\n") + std::string(16, 'x'));
  const std::string describe = "describe --out d.npy --source drive ";
  expect_refused(describe + "--model none.onnx", {"none.onnx"});
  expect_refused(describe + "--model noise.onnx", {"noise.onnx"});
  expect_refused(describe + "--model model.onnx --layer nosuch", {"nosuch", "layers"});
  expect_refused(describe + "--model " SEQLOOP_TEST_DATA "/four_channels.onnx", {"4", "channels"});
  expect_refused(describe + "--model model.onnx --input-size 0x5 --mean 1,2", {"0x5", "1,2"});
  expect_refused(describe + "--layer conv", {"layer", "--model"});
  folder_.write("model.toml", "laier = \"x\"\nscale = \"big\"\n");
  expect_refused(describe + "--model model.onnx",
                 {"model.toml:1", "did you mean 'layer'", "model.toml:2", "'scale'"});
}

TEST_F(BadInput, OutputsThatCannotBeWritten) {
  const std::string match =
      "match --method seqcnnslam --reference good.npy --query good.npy --out ";
  expect_refused(match + "none/m.csv", {"none"});
  expect_refused(match + ".", {"folder"});
  const test::Outcome full = run(match + "/dev/full");
  EXPECT_EQ(full.exit_code, 1) << "it fails while running";
  EXPECT_NE(full.err.find("/dev/full: "), std::string::npos) << full.err;
  folder_.write("file", "");
  expect_refused("run --source good.npy --exclude 20 --out r.jsonl --pictures file/pictures",
                 {"file/pictures"});
  EXPECT_FALSE(exists("r.jsonl"));
}

TEST_F(BadInput, AnOutputIsNeverAnInput) {
  const std::string good = test::read_all(file("good.npy"));
  std::filesystem::create_symlink(file("good.npy"), file("link.npy"));
  for (const std::string out : {"good.npy", "./good.npy", "link.npy"}) {
    expect_refused("match --method seqcnnslam --exclude 10 --query good.npy --out " + out,
                   {"destroy an input"});
    expect_refused("run --source wide.npy --reference good.npy --out " + out, {"destroy an input"});
  }
  EXPECT_EQ(test::read_all(file("good.npy")), good);
  std::filesystem::create_directory(file("drive"));
  folder_.write("drive/0.pgm", "P5 1 1 255\nx");
  expect_refused("describe --source drive --out drive/0.pgm", {"destroy an input"});
  std::filesystem::create_symlink("drive/0.pgm", file("picture"));
  std::filesystem::create_symlink("../good.npy", file("drive/1.pgm"));
  expect_refused("describe --source drive --out picture", {"destroy an input"});
  expect_refused("describe --source drive --out good.npy", {"destroy an input (source)"});
  expect_refused("run --source drive --out r.jsonl --pictures drive/.", {"among those of drive/."});
  EXPECT_EQ(test::read_all(file("good.npy")), good);
}

TEST_F(BadInput, AnOutputIsNoModelAndNoSettingsEither) {
  std::filesystem::create_directory(file("drive"));
  folder_.write("drive/0.pgm", std::string("P5 4 4 255\n") + std::string(16, 'x'));
  std::filesystem::copy_file(SEQLOOP_TEST_DATA "/gray_chain.onnx", file("net.onnx"));
  folder_.write("net.toml", "scale = 2\nconfig-model = \"net.prototxt\"\n");
  folder_.write("net.prototxt", "x");
  folder_.write("c.toml", "ds = 5\n");
  std::filesystem::create_hard_link(file("net.onnx"), file("twin"));
  std::filesystem::create_symlink(".", file("here"));
  const std::string here = "../" + folder_.path().filename().string();
  for (const std::string& out : std::vector<std::string>{"net.onnx", "./net.onnx", "twin",
                                                         "here/net.toml", here + "/net.prototxt"}) {
    expect_refused("describe --source drive --model net.onnx --out " + out,
                   {"destroy an input (model)"});
  }
  const std::string config = " --config c.toml --out here/c.toml";
  expect_refused("describe --source drive" + config, {"destroy an input (config)"});
  expect_refused("match --query good.npy" + config, {"destroy an input (config)"});
  expect_refused("run --source good.npy" + config, {"destroy an input (config)"});
  expect_refused("run --source good.npy --config c.toml --out r --summary ./c.toml",
                 {"destroy an input (config)"});
  folder_.write("out.toml", "out = \"./out.toml\"\n");
  expect_refused("match --query good.npy --config out.toml", {"destroy an input (config)"});
  EXPECT_EQ(test::read_all(file("c.toml")), "ds = 5\n");
}

TEST_F(BadInput, NoTwoOutputsAreOne) {
  std::filesystem::create_directory(file("p"));
  std::filesystem::create_symlink("p", file("same"));
  folder_.write("old", "");
  std::filesystem::create_hard_link(file("old"), file("twin"));
  const std::string run = "run --source good.npy --exclude 20 ";
  for (const std::string names :
       {"--out a.json --summary ./a.json", "--out p/a.json --summary same/a.json",
        "--out old --summary twin", "--out - --summary /dev/stdout"}) {
    expect_refused(run + names, {"summary: is the same file as --out"});
  }
  expect_refused(run + "--summary both >both", {"summary: is the same file as --out"});
  expect_refused(run + "--pictures p --out same/matches.png", {"is the same file as --out"});
  expect_refused(run + "--out new --pictures new", {"pictures: is the same file as --out"});
  EXPECT_EQ(Program::run(run + "--out /dev/null --summary - >/dev/null").exit_code, 0);
}

TEST_F(BadInput, OutputPathsAreCheckedWithEverythingElse) {
  expect_refused("match --method x --query none.npy --ds 0 --out none/m.csv",
                 {"'x'", "none.npy", "ds: 0", "none/m.csv"});
  expect_refused("run --source good.npy --ds 0 --out none/x --pictures /dev/null/p --fps 0",
                 {"ds: 0", "none/x", "/dev/null", "fps"});
  expect_refused("describe --source none --out none/d.npy", {"none: ", "none/d.npy"});
  expect_refused("describe --source none --out - >>app.npy", {"none: ", "streamed"});
}

TEST_F(BadInput, StandardStreamsThatAreFullOrClosed) {
  for (const char* verb : {"plan", "--help"}) {
    const test::Outcome full = run(verb + std::string(" >/dev/full"));
    EXPECT_EQ(full.exit_code, 1);
    EXPECT_EQ(full.err, "seqloop: standard output: cannot be written: No space left on device\n");
  }
  const std::string match =
      "match --method seqcnnslam --reference good.npy --query good.npy --out m.csv ";
  EXPECT_EQ(run(match + "2>&-").exit_code, 0);
  EXPECT_EQ(run(match + "<&- 2>&-").exit_code, 0);
  EXPECT_EQ(test::read_all(file("m.csv")).find("seqloop:"), std::string::npos);
}

TEST_F(BadInput, AFileMayNotGrowBeyondWhatTheUserIsAllowed) {
  write_npy("long.npy", oracle::drive(1, 400, 12));
  const std::string match =
      "match --method seqcnnslam --reference long.npy --query long.npy --out m.csv";
  const test::Outcome outcome =
      run("--version >/dev/null; ulimit -f 1; '" SEQLOOP_BINARY "' " + match);
  EXPECT_EQ(outcome.exit_code, 1) << "no signal";
  EXPECT_NE(outcome.err.find("m.csv: cannot be written: File too large"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(listing().find("m.csv"), std::string::npos) << listing();
  EXPECT_EQ(run("--version >/dev/null; ulimit -f 0; '" SEQLOOP_BINARY "' plan").exit_code, 1);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they want terabytes
TEST_F(BadInput, WhereMemoryIsShortTheProgramStillEnds) {
  // Enough for the work, and too little for a second thread of OpenBLAS, whose memory comes in
  // pieces of 128 MiB.
  const std::string match =
      "match --method seqcnnslam --reference good.npy --query good.npy --out m.csv";
  for (const std::string& arguments : {std::string("plan"), match}) {
    const test::Outcome outcome =
        run("--version >/dev/null; ulimit -v 400000; timeout -s KILL 60 '" SEQLOOP_BINARY "' " +
            arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_TRUE(exists("m.csv"));
}
#endif

TEST_F(BadInput, NothingFromOutsideSpeaksToTheTerminal) {
  const std::string red = "\x1B[31mred\n.npy";
  const test::Outcome refused = run("match --method seqcnnslam --out m.csv --query '" + red + "'");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("\\x1B[31mred\\x0A.npy: "), std::string::npos) << refused.err;
  EXPECT_EQ(refused.err.find('\x1B'), std::string::npos);
  std::filesystem::copy_file(file("good.npy"), file(red));
  const test::Outcome done = run(
      "match --method seqcnnslam --query good.npy --reference good.npy --out '" + red + ".csv'");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err.find('\x1B'), std::string::npos);
}

TEST_F(BadInput, ALongCellIsNoLongMessage) {
  folder_.write("list.csv",
                "query,match,score,uniqueness\n1," + std::string(10'000'000, 'x') + ",0.5,0.5\n");
  const test::Outcome outcome = run("eval --matches list.csv");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_LT(outcome.err.size(), 5'000U);
  EXPECT_NE(outcome.err.find("list.csv:2"), std::string::npos) << outcome.err.substr(0, 200);
}

TEST_F(BadInput, TextFilesThatAreNone) {
  std::filesystem::create_directory(file("folder"));
  const std::string match = "--reference good.npy --query good.npy --config ";
  for (const std::string text : {"folder", "/dev/zero", "none"}) {
    expect_match_refused(match + text, {text});
    expect_refused("eval --matches " + text, {text});
    expect_refused("eval --matches none --truth " + text, {text});
  }
  expect_match_refused(match + "good.npy", {"good.npy: is no text in UTF-8"});
  expect_refused("eval --matches good.npy --truth good.npy", {"good.npy: is no text in UTF-8"});
  std::string deep = "[a";
  for (int level = 0; level < 100'000; ++level) deep += ".a";
  folder_.write("deep.toml", deep + "]\n");
  expect_match_refused(match + "deep.toml", {"deep.toml:1", "nested"});
}

TEST_F(BadInput, AbsurdFrameNumbersCostNothing) {
  // As large as a number of frames may be on 64 bits, and on 32.
  constexpr bool wide = sizeof(std::size_t) > 4;
  const std::string frame = wide ? "99999999999" : "3999999999";
  const std::string frames = wide ? "999999999999" : "4000000000";
  folder_.write("list.csv",
                "\xEF\xBB\xBFquery,match,score,uniqueness\n" + frame + "," + frame + ",1,1\n");
  const test::Outcome outcome = run("eval --json --matches list.csv --frames " + frames);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\"correct\": 1"), std::string::npos) << outcome.out;
  folder_.write("list.csv", "query,match,score,uniqueness\n18446744073709551615,1,1,1\n");
  expect_refused("eval --matches list.csv", {"18446744073709551615"});
}

TEST_F(BadInput, MatchListsAndTruths) {
  folder_.write("list.csv", "query,match,score,uniqueness\n1,1,0.5,0.5\n1,2,0.5,0.5\n");
  expect_refused("eval --matches list.csv", {"list.csv:3: query 1 is answered twice"});
  folder_.write("lines.jsonl", R"({"frame": 1, "match": 1, "uniqueness": 0.5}
{"frame": 1, "match": 2, "uniqueness": 0.5}
{"frame": 2, "match": "x", "uniqueness": 0.5})");
  expect_refused("eval --matches lines.jsonl",
                 {"lines.jsonl:2: query 1 is answered twice", "lines.jsonl:3: 'match'"});
  folder_.write("list.csv", "query,match,score,uniqueness\n1,one,0.5,0.5\n");
  expect_refused("eval --matches list.csv", {"list.csv:2", "'one'"});
  folder_.write("list.csv", "query,match\n1,1\n");
  expect_refused("eval --matches list.csv", {"uniqueness"});
  folder_.write("list.csv", "query,match,score,uniqueness\n1,1,0.5\n");
  expect_refused("eval --matches list.csv", {"list.csv:2", "3 cells"});
  folder_.write("list.csv", "query,match,score,uniqueness\n1,1\n2,x,0.5,0.5\n3,\"3,1,1\n4\n");
  expect_refused("eval --matches list.csv",
                 {"list.csv:2: 2 cells under a header of 4", "list.csv:3: 'x' under 'match'",
                  "list.csv:4: a cell in quotes", "list.csv:5: 1 cell under"});
  folder_.write("list.csv", "");
  expect_refused("eval --matches list.csv --truth none.csv", {"list.csv", "none.csv"});
  expect_refused("eval --threshold-on x", {"threshold-on", "--matches"});
  folder_.write("list.csv", "query,match,score,uniqueness\n1,1,0.5,0.5\n");
  expect_refused("eval --matches list.csv --threshold-on probability", {"'probability'"});
  expect_refused("eval --matches list.csv --unlisted unknown", {"unlisted", "--truth"});
  expect_refused("eval --matches list.csv --truth t.csv --unlisted right", {"'right'", "t.csv"});
}

/// It is no fault, but the user is told what is not done.
TEST_F(BadInput, AReferenceOfMorePlacesThanAreLookedThrough) {
  const oracle::Vectors drive = oracle::drive(1, 20'001, 12);
  write_npy("long.npy", drive);
  const std::string match = "match --query good.npy --out m.csv --reference long.npy";
  const std::string told = "places after the first 20000 of the reference";
  const test::Outcome outcome = run(match);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find(told), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("seqloop run --source REFERENCE --map FILE"), std::string::npos)
      << outcome.err;
  // By uniqueness visits are nothing.
  const test::Outcome by_uniqueness = run(match + " --decide-by uniqueness");
  EXPECT_EQ(by_uniqueness.exit_code, 0) << by_uniqueness.err;
  EXPECT_EQ(by_uniqueness.err.find(told), std::string::npos);
  write_npy("long.npy", oracle::Vectors(drive.begin(), drive.end() - 1));
  const test::Outcome shorter = run(match);
  EXPECT_EQ(shorter.exit_code, 0) << shorter.err;
  EXPECT_EQ(shorter.err.find(told), std::string::npos);
}

TEST_F(BadInput, AnOutputBecomesNoPartOfTheDrive) {
  std::filesystem::create_directories(file("drive/more"));
  for (const std::string name : {"0.jpg", "0.PNG", "loops.mcap", "m.db3"}) {
    expect_refused(
        "run --source drive --out drive/" + name,
        {"out: drive/" + name + " would be read as a part of drive the next time (source)"});
    const test::Outcome outcome = run("run --source drive --out drive/more/" + name);
    EXPECT_EQ(outcome.err.find("would be read"), std::string::npos) << outcome.err;
  }
  // Neither the first time, nor when it is there.
  for (int time = 0; time < 2; ++time) {
    const test::Outcome table = run("run --source drive --out drive/answers.jsonl");
    EXPECT_EQ(table.err.find("would"), std::string::npos) << table.err;
    folder_.write("drive/answers.jsonl", "{}");
  }
  folder_.write("drive/0.jpg", "a picture");
  std::filesystem::create_hard_link(file("drive/0.jpg"), file("drive/other.jsonl"));
  expect_refused("run --source drive --out drive/other.jsonl",
                 {"out: writing drive/other.jsonl would destroy an input (source)"});
}

TEST_F(BadInput, OutputsThatCannotBeLookedUpAreNotOne) {
  std::filesystem::create_symlink("loop", file("loop"));
  const test::Outcome outcome =
      run("run --source good.npy --out loop/a --summary loop/b --pictures loop");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err.find("is the same file"), std::string::npos) << outcome.err;
}

TEST_F(BadInput, PipesThatNobodyReadsEndWithTheFirstSignal) {
  folder_.write("stop.sh",
                "mkfifo s b\n"
                "env --default-signal=INT,TERM \"$@\" &\n"
                "until ls -d .r.partial-* >/dev/null 2>&1; do sleep 0.01; done\n"
                "sleep 0.5\n"
                "kill -TERM $!\n"
                "for i in 1 2 3 4 5 6 7 8 9; do kill -0 $! 2>/dev/null && sleep $i; done\n"
                "kill -KILL $! 2>/dev/null\n"
                "wait $!\n");
  const std::string command =
      "cd '" + folder_.path().string() +
      "' && sh stop.sh '" SEQLOOP_BINARY
      "' run --source good.npy --out r --summary s --out-bag b 2>stderr.txt";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_EQ(test::read_all(file("stderr.txt")), "seqloop: interrupted: nothing has been written\n");
  EXPECT_EQ(listing().find("partial"), std::string::npos) << listing();
}

TEST_F(BadInput, WordsThatAreNearlyRight) {
  std::filesystem::create_directory(file("day"));
  expect_refused("run day", {"day: stands after no flag; say what it is, as in --source"});
  expect_refused("match --query good.npy --out m.csv --method O-SeqCNNSLAM",
                 {"method: 'O-SeqCNNSLAM' is no known method; did you mean 'o-seqcnnslam'?"});
}

TEST_F(BadInput, DrivesWithoutAnyByte) {
  // Read, the kernel's log keeps its reader waiting, and no signal ends that.
  std::filesystem::create_symlink("/proc/kmsg", file("log.avi"));
  std::filesystem::create_symlink("/proc/kmsg", file("log.npy"));
  folder_.write("empty.mp4", "");
  expect_refused("run --source log.avi --reference log.npy",
                 {"log.avi: is empty", "log.npy: is empty"});
  expect_refused("describe --source empty.mp4 --out d.npy", {"empty.mp4: is empty"});
  expect_match_refused("--query log.npy", {"log.npy: is empty"});
  std::filesystem::create_symlink("/proc/kmsg", file("log.db3"));
  expect_refused("run --source log.db3", {"log.db3: is empty; name a drive"});
  expect_refused("report log.npy --out p.html",
                 {"log.npy: is empty; name what `seqloop run --out`"});
}

TEST_F(BadInput, FlagsThatDoNothing) {
  folder_.write("video.avi", "");
  folder_.write("drive.mcap", "");
  std::filesystem::create_directory(file("pictures"));
  const std::string described = ": the drives are described already";
  expect_refused(
      "run --source good.npy --reference good.npy --model a.onnx --layer x --scale 2 "
      "--descriptor patches --training a --words 4 --remove-components 3",
      {"model" + described, "layer" + described, "scale" + described, "descriptor" + described,
       "training" + described, "words" + described, "remove-components" + described});
  for (const std::string source :
       {"run --source good.npy", "run --source /dev/null", "run --source ros:/camera",
        "describe --source pictures", "stills --source video.avi --out stills"}) {
    expect_refused(source + " --topic /camera", {"topic: it goes with a bag, and none is given"});
  }
  const std::string rate = "fps: it goes with image folders, descriptors and cameras";
  for (const std::string verb : {"run", "describe", "stills"}) {
    expect_refused(verb + " --source video.avi --fps 5", {rate});
    expect_refused(verb + " --source drive.mcap --fps 5", {rate});
  }
  expect_refused("describe --source pictures --format GREY --size 8x8",
                 {"format: it goes with a camera", "size: it goes with a camera"});
  expect_refused("camera --format GREY --size 8x8 --fps 5",
                 {"format: nothing is captured", "size: nothing", "fps: nothing"});
  expect_refused(
      "run --source good.npy --grow all --save-every-s 2 --thumbnails off "
      "--fleet-places 7",
      {"grow: there is no map", "save-every-s: there is no map", "thumbnails: there is no map",
       "fleet-places: there are no others"});
  for (const std::string name : {"gar*", "gar?ge", "gar[a-d]ge"}) {
    expect_refused(
        "run --source good.npy --fleet '" + name + "'",
        {"fleet: '" + name + "' would be a pattern", "what is told are places of a map"});
  }
  expect_refused("run --source good.npy --overload-every 3",
                 {"overload-every: the newest frame is taken, not every n-th"});
  for (const std::string verb : {"run --reference good.npy --source good.npy ",
                                 "match --reference good.npy --query good.npy ", "plan "}) {
    expect_refused(verb + "--full-map thin --slice 5000 --relocalise-s 3",
                   {"full-map: a map that is only localised in", "relocalise-s: --slice says"});
    expect_refused(verb +
                       "--paper --slice 5000 --relocalise-s 3 --distances 300 "
                       "--standardise-prior 9 --standardise-horizon 9",
                   {"slice: no part", "distances: it goes", "standardise-prior: features",
                    "standardise-horizon: features"});
  }
  expect_refused("bench --only step --model a.onnx --topic /camera",
                 {"model: describing is not timed", "topic: it goes with a bag"});
  expect_refused("bench --only step --n 0 --d 0",
                 {"seqloop: n: 0 is not between", "seqloop: d: 0 is not between"});
  // A default that is written out is what happens anyway, and the contract's flags go with any
  // method.
  const test::Outcome outcome =
      run("run --source good.npy --reference good.npy --full-map refuse --fps 10 --fleet-places "
          "20000 --grow novel --method seqcnnslam --k 9 --num 15 --reinit 400 --initial-k 20 "
          "--exclude 30 --rwindow 8");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(BadInput, Cameras) {
  folder_.write("file.txt", "no camera");
  expect_refused("camera --device /no/camera", {"/no/camera", "there is no camera"});
  expect_refused("camera --device /dev/null --frames 3", {"/dev/null", "no camera"});
  expect_refused("camera --device file.txt", {"file.txt", "a file, no camera"});
  expect_refused("camera --device . --frames 1", {"a folder, no camera"});
  expect_refused("camera --frames 0", {"frames"});
  expect_refused("camera --format H264 --size 640 --fps 0", {"format", "size", "fps"});
  expect_refused("run --source good.npy --format MJPG --size 320x240 --give-up-s 3",
                 {"format: it goes with a camera", "size: it goes", "give-up-s: it goes"});
}

}  // namespace
}  // namespace seqloop
