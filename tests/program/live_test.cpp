// SPDX-License-Identifier: MIT
// A recording played at its own rate through the real binary: ring, budget, policy, summary.
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/oracle.hpp"
#include "platform/pictures.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

using Json = nlohmann::json;

class Live : public test::Program {
 protected:
  void write_drive(const std::string& name, std::size_t frames) const {
    const oracle::Vectors rows = oracle::drive(11, frames, 24, 0.2F);
    files::NpyWriter writer(file(name), 24);
    for (const auto& row : rows) writer.append(row);
    writer.commit();
  }
  [[nodiscard]] std::vector<Json> lines(const std::string& name) const {
    std::istringstream text(test::read_all(file(name)));
    std::vector<Json> all;
    for (std::string line; std::getline(text, line);) all.push_back(Json::parse(line));
    return all;
  }
  [[nodiscard]] Json json(const std::string& name) const {
    return Json::parse(test::read_all(file(name)));
  }
};

TEST_F(Live, EveryFrameOfTheRecordingIsTakenOrCounted) {
  write_drive("q.npy", 120);
  const test::Outcome outcome =
      run("run --source q.npy --ds 5 --exclude 20 --fps 400 --pace live --out r.jsonl "
          "--summary s.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = json("s.json");
  std::uint64_t frames = 0;
  std::uint64_t missing = 0;
  for (const Json& line : lines("r.jsonl")) {
    if (line["newest"].is_null()) continue;  // the answers that were left at the end
    ++frames;
    missing += line["dropped"].get<std::uint64_t>() + line["lost"].get<std::uint64_t>();
    EXPECT_GE(line["age_ms"].get<double>(), 0.0);
    EXPECT_EQ(line["newest"].get<std::uint64_t>() + 1, frames + missing)
        << "frames have the recording's own numbers";
  }
  EXPECT_EQ(summary["frames"], frames);
  const auto count = [&](const char* name) { return summary["captured"][name].get<int>(); };
  EXPECT_EQ(count("grabbed") + count("lost"), 120);
  EXPECT_EQ(count("grabbed"), count("taken") + count("dropped"));
  for (const char* stage : {"grab", "describe", "match", "total", "age", "answer"}) {
    std::uint64_t counted = 0;
    for (const Json& bucket : summary["stages"][stage]["buckets"]) {
      counted += bucket[1].get<std::uint64_t>();
    }
    EXPECT_EQ(counted, frames) << stage;
  }
  EXPECT_NE(outcome.err.find(" grabbed: "), std::string::npos) << outcome.err;
}

TEST_F(Live, AnOverloadedLoopSaysSoAndThinsOutAsDeclared) {
  write_drive("q.npy", 200);
  const test::Outcome outcome =
      run("run --source q.npy --ds 5 --exclude 20 --fps 400 --pace live --out r.jsonl "
          "--budget-total 1e-6 --overload-policy every-nth --overload-every 3 --overload-after 4 "
          "--summary s.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::uint64_t overloaded = 0;
  for (const Json& line : lines("r.jsonl")) {
    if (line["newest"].is_null()) continue;  // the answers that were left at the end
    EXPECT_TRUE(line["deadline_missed"]);
    EXPECT_EQ(line["missed"], Json::array({"total"}));
    if (line["overloaded"]) {
      ++overloaded;
    } else {
      EXPECT_EQ(overloaded, 0U) << "no frame can be within this budget";
    }
  }
  EXPECT_GT(overloaded, 3U);
  const Json summary = json("s.json");
  EXPECT_EQ(summary["overload"]["policy"], "every-nth");
  EXPECT_EQ(summary["overload"]["times"], 1);
  EXPECT_EQ(summary["overload"]["frames"], overloaded);
  EXPECT_EQ(summary["misses"], summary["frames"]);
  EXPECT_EQ(summary["missed"]["total"], summary["misses"]);
  EXPECT_GT(summary["captured"]["dropped"].get<std::uint64_t>(), overloaded) << "two of three";
  EXPECT_NE(outcome.err.find("taking one frame of 3"), std::string::npos) << outcome.err;
}

TEST_F(Live, AtMaximalPaceNothingIsDroppedAndThereIsNoAge) {
  write_drive("q.npy", 60);
  const test::Outcome outcome =
      run("run --source q.npy --ds 5 --exclude 20 --out r.jsonl --budget-total 1e-6 "
          "--overload-after 1 --summary s.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const Json& line : lines("r.jsonl")) {
    EXPECT_EQ(line["dropped"], 0);
    EXPECT_FALSE(line["overloaded"]);
  }
  const Json summary = json("s.json");
  EXPECT_EQ(summary["frames"], 60);
  EXPECT_FALSE(summary.contains("captured"));
  EXPECT_FALSE(summary["stages"].contains("age"));
}

TEST_F(Live, AReaderThatStoppedReadingDoesNotKeepItFromStopping) {
  write_drive("q.npy", 3000);
  // 3,000 lines do not fit into a pipe; the program is stopped while it waits for the reader.
  folder_.write(
      "stop.sh",
      "mkfifo pipe\nsleep 60 <pipe &\n"
      "'" SEQLOOP_BINARY
      "' run --source q.npy --ds 5 --exclude 20 --summary s.json >pipe 2>err.txt &\n"
      "program=$!\n"
      "for i in $(seq 300); do ls .s.json.partial-* >/dev/null && break; sleep 0.1; done\n"
      "sleep 3\nkill -TERM $program\nwait $program\necho $? >code.txt\nkill %1\n");
  static_cast<void>(
      std::system(("cd '" + folder_.path().string() + "' && bash stop.sh 2>/dev/null").c_str()));
  EXPECT_EQ(test::read_all(file("code.txt")), "1\n") << test::read_all(file("err.txt"));
  EXPECT_NE(test::read_all(file("err.txt")).find("nobody reads it"), std::string::npos);
  EXPECT_GT(json("s.json")["frames"], 10) << "the summary is there all the same";
}

TEST_F(Live, WaitsForEachFramesTime) {
  write_drive("q.npy", 30);
  const auto begin = std::chrono::steady_clock::now();
  const test::Outcome outcome =
      run("run --source q.npy --ds 5 --exclude 5 --fps 100 --pace live --out r.jsonl");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // A lower bound only: frame 29 is due at 0.29 s however slow the machine is.
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(280));
}

TEST_F(Live, AnInterruptedRunEndsInOrder) {
  write_drive("good.npy", 60);
  for (const std::string signal : {"INT", "TERM", "HUP"}) {
    // Whoever runs the tests may have signals ignored, and the program respects that. The first
    // line in its partial output shows that it has begun.
    std::filesystem::remove(file("r.jsonl"));
    folder_.write("stop.sh",
                  "env --default-signal=INT,TERM,HUP \"$@\" &\n"
                  "until grep -qs newest .r.jsonl.partial-*; do sleep 0.1; done\n"
                  "kill -" +
                      signal + " $!; wait $!\n");
    const std::string command =
        "cd '" + folder_.path().string() +
        "' && sh stop.sh '" SEQLOOP_BINARY
        "' run --pace live --fps 0.01 --source good.npy --exclude 20 --out r.jsonl 2>stderr.txt";
    EXPECT_EQ(std::system(command.c_str()), 0) << signal << test::read_all(file("stderr.txt"));
    EXPECT_NE(test::read_all(file("stderr.txt")).find("1 frame: "), std::string::npos) << signal;
    EXPECT_TRUE(exists("r.jsonl"));
    EXPECT_EQ(listing().find("partial"), std::string::npos) << listing();
  }
}

TEST_F(Live, InterruptedBeforeItsFirstFrameItKeepsWhatWasThere) {
  std::filesystem::create_directory(file("drive"));
  folder_.write("drive/0.png", test::encoded(test::textured(160, 120, 1), ".png"));
  for (int i = 1; i < 20'000; ++i) {
    std::filesystem::create_hard_link(file("drive/0.png"),
                                      file("drive/" + std::to_string(i) + ".png"));
  }
  folder_.write("r.jsonl", "old");
  folder_.write("stop.sh",
                "env --default-signal=INT \"$@\" 2>stderr.txt &\n"
                "until grep -qs learning stderr.txt; do sleep 0.01; done\n"
                "kill -INT $!; wait $!\n");
  for (const std::string verb : {"run", "describe"}) {
    std::filesystem::remove(file("stderr.txt"));
    const std::string command =
        "cd '" + folder_.path().string() + "' && sh stop.sh '" SEQLOOP_BINARY "' " + verb +
        " --source drive --descriptor words --training drive --out r.jsonl 2>err.txt";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    const std::string said = test::read_all(file("stderr.txt"));
    EXPECT_NE(said.find("interrupted: nothing has been written"), std::string::npos) << said;
    EXPECT_EQ(test::read_all(file("r.jsonl")), "old");
    EXPECT_EQ(listing().find("partial"), std::string::npos) << listing();
  }
}

TEST_F(Live, WarmsUpAtOnceHoweverWideItIsSet) {
  write_drive("q.npy", 60);
  const test::Outcome outcome =
      run("run --source q.npy --reference q.npy --ds 5 --rwindow 1000000000 --out r.jsonl");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Live, WarmsUpWhereAMapThatForgetsIsDrivenThroughFast) {
  write_drive("q.npy", 120);
  const test::Outcome outcome =
      run("run --source q.npy --full-map thin --vmin 3 --vmax 4 --out r.jsonl");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Live, StopsAfterAsManyFramesAsAskedFor) {
  write_drive("q.npy", 60);
  const test::Outcome outcome =
      run("run --source q.npy --ds 5 --exclude 20 --frames 40 --out r.jsonl");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(lines("r.jsonl").size(), 40U);
}

TEST_F(Live, TellsEveryFaultOfItsLimitsAtOnce) {
  write_drive("q.npy", 60);
  const test::Outcome outcome =
      run("run --source q.npy --out r.jsonl --budget-total 0 --budget-age -1 --budget-match 1e10 "
          "--overload-every 1 --overload-after 0 --overload-recover 0 --overload-policy skip "
          "--realtime-priority 99 --realtime-cpus 1,,2 --summary r.jsonl");
  EXPECT_EQ(outcome.exit_code, 2);
  for (const char* fault :
       {"budget-total", "budget-age", "budget-match", "overload-every", "overload-after",
        "overload-recover", "overload-policy", "realtime-priority", "realtime-cpus", "summary"}) {
    EXPECT_NE(outcome.err.find(fault), std::string::npos) << fault << '\n' << outcome.err;
  }
  EXPECT_EQ(listing(), "q.npy ");
}

TEST_F(Live, AConfigurationFileSetsTheBudget) {
  write_drive("q.npy", 60);
  folder_.write("c.toml",
                "ds = 5\nexclude = 20\n[budget]\ntotal = 7\nmatch = 3\n[overload]\npolicy = "
                "\"every-nth\"\nafter = 9\n");
  const test::Outcome outcome =
      run("run --config c.toml --source q.npy --out r.jsonl --summary s.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = json("s.json");
  EXPECT_EQ(summary["budget_ms"]["total"], 7.0);
  EXPECT_EQ(summary["budget_ms"]["match"], 3.0);
  EXPECT_EQ(summary["overload"]["policy"], "every-nth");
  EXPECT_EQ(summary["overload"]["after"], 9);
}

TEST_F(Live, OfAnInterruptedReportNothingStays) {
  write_drive("q.npy", 60);
  ASSERT_EQ(run("run --source q.npy --ds 5 --exclude 20 --out r.jsonl").exit_code, 0);
  // A run without end: frames 110 to 159, 210 to 259, and so on.
  folder_.write("stop.sh",
                "mkfifo run && { n=0; while n=$((n+1)); tail -n +11 r.jsonl | sed "
                "'s/\"newest\":/&'$n'/'; do :; done >run 2>/dev/null & }\n"
                "writer=$!\n"
                "env --default-signal=INT \"$@\" 2>stderr.txt &\n"
                "until ls -d .p.html.partial-* >/dev/null 2>&1; do sleep 0.01; done\n"
                "kill -INT $!; wait $!; code=$?\n"
                "kill $writer 2>/dev/null; exit $code\n");
  const std::string command = "cd '" + folder_.path().string() +
                              "' && sh stop.sh '" SEQLOOP_BINARY "' report run --out p.html";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_EQ(test::read_all(file("stderr.txt")), "seqloop: interrupted: nothing has been written\n");
  EXPECT_EQ(listing().find("p.html"), std::string::npos) << listing();
}

TEST_F(Live, TheReportIsOnePage) {
  write_drive("q.npy", 60);
  ASSERT_EQ(run("run --source q.npy --ds 5 --exclude 20 --fps 500 --pace live --out r.jsonl "
                "--summary s.json")
                .exit_code,
            0);
  const test::Outcome outcome = run("report r.jsonl --summary s.json --out p.html");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = test::read_all(file("p.html"));
  const std::string begin = "<script type=\"application/json\" id=\"report\">";
  const std::size_t at = page.find(begin) + begin.size();
  const Json data = Json::parse(page.substr(at, page.find("</script>", at) - at));
  const Json summary = json("s.json");
  EXPECT_EQ(data["status"]["counts"]["frames"], summary["frames"]);
  EXPECT_EQ(data["status"]["counts"]["gates"], summary["gates"]);
  EXPECT_EQ(data["status"]["run"]["budget_ms"], summary["budget_ms"]);
  EXPECT_EQ(data["status"]["run"]["source"], "q.npy");
  EXPECT_EQ(run("report s.json --out x.html").exit_code, 2) << "these are no lines";
  EXPECT_EQ(run("report missing.jsonl --out x.html").exit_code, 2);
  EXPECT_EQ(run("report r.jsonl --summary r.jsonl --out x.html").exit_code, 2);
  EXPECT_EQ(run("report r.jsonl --out r.jsonl").exit_code, 2) << "an input is not written over";
  folder_.write("twice.jsonl", test::read_all(file("r.jsonl")) + test::read_all(file("r.jsonl")));
  EXPECT_EQ(run("report twice.jsonl --out x.html").exit_code, 2) << "two runs";
  // A live run may lose as many frames as this one leaves out.
  ASSERT_EQ(run("run --source q.npy --ds 5 --exclude 20 --summary whole.json").exit_code, 0);
  ASSERT_EQ(run("run --source q.npy --ds 5 --exclude 20 --frames 50 --out half.jsonl").exit_code,
            0);
  const test::Outcome half = run("report half.jsonl --summary whole.json --out x.html");
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_NE(half.err.find("has 50; give the summary of that run"), std::string::npos) << half.err;
  EXPECT_FALSE(exists("x.html"));
}

}  // namespace
}  // namespace seqloop
