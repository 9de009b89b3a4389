// SPDX-License-Identifier: MIT
// The real program, killed while it saves, and on disks that are full or stall.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include "core/oracle.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t frames = 800;
constexpr int kills = SEQLOOP_KILLS;

/// A program that runs beside the test; killed with it.
class Process {
 public:
  /// @param prepare runs in the child, before the program
  Process(const std::vector<std::string>& arguments, const std::string& out, const std::string& err,
          const std::function<void()>& prepare = {}) {
    // Before there is a process: whoever reads them never finds what the one before has said.
    const int to_out = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    const int to_err = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    pid_ = ::fork();
    if (pid_ != 0) {
      ::close(to_out);
      ::close(to_err);
      return;
    }
    ::dup2(to_out, STDOUT_FILENO);
    ::dup2(to_err, STDERR_FILENO);
    if (prepare) prepare();
    std::vector<char*> words;
    for (const std::string& argument : arguments)
      words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    ::execv(words.front(), words.data());
    ::_exit(127);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  Process(Process&&) = delete;
  Process& operator=(Process&&) = delete;
  ~Process() { kill(); }

  [[nodiscard]] pid_t pid() const { return pid_; }

  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

  /// @return the exit code
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = 0;
};

class MapProcess : public test::Program {
 protected:
  void SetUp() override { write_drive("drive.npy", frames, 40); }

  void write_drive(const std::string& name, std::size_t rows, std::size_t values) const {
    files::NpyWriter writer(file(name), values);
    for (const auto& row : oracle::drive(1, rows, values, 0.2F)) writer.append(row);
    writer.commit();
  }

  [[nodiscard]] std::vector<std::string> drive(const std::string& map, const std::string& session,
                                               std::vector<std::string> more) const {
    std::vector<std::string> words{SEQLOOP_BINARY, "run"};
    const auto add = [&words](const std::string& name, const std::string& value) {
      words.push_back("--" + name);
      words.push_back(value);
    };
    add("source", file("drive.npy"));
    add("map", file(map));
    add("session", session);
    add("pace", "live");
    add("save-every-s", "0.02");
    add("standardise", "off");
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

#ifdef SEQLOOP_STALLING_DISK
  /// In a drive's process: its disk takes nothing while there is a file `stall`.
  void use_stalling_disk() const {
    ::setenv("LD_PRELOAD", SEQLOOP_STALLING_DISK, 1);
    ::setenv("SEQLOOP_STALL", file("stall").c_str(), 1);
  }
#endif

  /// Waits until a file has these words. @return whether it ever had
  [[nodiscard]] bool says(const std::string& name, const std::string& words) const {
    for (int n = 0; n < 6'000; ++n) {
      if (test::read_all(file(name)).find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }

  /// Waits until a session of a map has frames. @return whether it ever had
  [[nodiscard]] bool has_frames(const std::string& map, const std::string& session) const {
    for (int n = 0; n < 6'000; ++n) {
      try {
        for (const auto& facts : sqlite::MapFile::read_only(file(map)).sessions()) {
          if (facts.name == session && facts.frames > 0) return true;
        }
      } catch (const SetupError&) {  // it is not there yet
      }
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }

  /// What a run has said: frames that it took, and the last number of saved ones.
  struct Said {
    std::vector<std::uint64_t> taken;
    std::uint64_t saved = 0;
  };
  [[nodiscard]] Said said(const std::string& name) const {
    const std::string text = test::read_all(file(name));
    Said all;
    for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos;
         at = end + 1) {
      const auto json = nlohmann::json::parse(text.substr(at, end - at));
      all.saved = json["saved"].get<std::uint64_t>();
      if (json["newest"].is_number()) all.taken.push_back(json["newest"].get<std::uint64_t>());
    }
    return all;
  }

  using Bytes = std::vector<std::byte>;
  struct Session {
    std::uint64_t frames = 0;
    std::map<std::uint64_t, Bytes> places;  // by frame
  };
  [[nodiscard]] std::map<std::string, Session> sessions(const std::string& name) const {
    const sqlite::MapFile map = sqlite::MapFile::read_only(file(name));
    std::map<std::string, Session> all;
    std::map<std::int64_t, std::string> names;
    for (const sqlite::SessionFacts& facts : map.sessions()) {
      names[facts.id] = facts.name;
      all[facts.name].frames = facts.frames;
    }
    const auto size = static_cast<std::size_t>(map.form().place_bytes);
    map.read([&](const sqlite::PlaceBlock& block) {
      for (std::size_t i = 0; i < block.records.size(); ++i) {
        const auto bytes = block.places.subspan(i * size, size);
        all[names[block.session]].places[block.records[i].frame] = {bytes.begin(), bytes.end()};
      }
    });
    return all;
  }

  /// Kills runs at random moments; each adds a session to the map that the one before has left.
  /// @param most places of the map; 0: all are kept
  void kill_runs(unsigned seed, int times, std::size_t most) {
    std::mt19937 random(seed);
    ASSERT_EQ(
        run("match --query drive.npy --map whole.seqloop --standardise off --out m.csv").exit_code,
        0);
    const Session whole = sessions("whole.seqloop").begin()->second;
    ASSERT_EQ(whole.places.size(), frames);
    std::vector<std::string> more;
    if (most > 0) more = {"--max-places", std::to_string(most), "--full-map", "forget-oldest"};
    more.insert(more.end(), {"--fps", "400"});
    std::map<std::string, Session> before;
    std::uint64_t acknowledged_in_all = 0;
    for (int n = 0; n < times; ++n) {
      const std::string name = "s" + std::to_string(n);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", kill " + std::to_string(n));
      if (n % 10 == 0) {  // else each run would have more to load than the one before
        for (const char* part : {"m.seqloop", "m.seqloop-wal", "m.seqloop-shm"}) {
          std::filesystem::remove(file(part));
        }
        before.clear();
      }
      {
        Process process(drive("m.seqloop", name, more), file("lines"), file("err"));
        // A quarter of them while they start.
        if (random() % 4 != 0) {
          ASSERT_TRUE(says("lines", "\n")) << test::read_all(file("err"));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
        process.kill();
      }
      const Said lines = said("lines");
      acknowledged_in_all += lines.saved;
      if (before.empty() && lines.saved == 0 && run("map info m.seqloop").exit_code != 0) continue;
      const test::Outcome check = run("map check m.seqloop");
      ASSERT_EQ(check.exit_code, 0) << check.err;
      std::map<std::string, Session> now = sessions("m.seqloop");
      std::size_t places = 0;
      for (const auto& [session, is] : now) places += is.places.size();
      for (const auto& [session, was] : before) {
        ASSERT_TRUE(now.contains(session)) << session;
        EXPECT_EQ(now[session].frames, was.frames) << session;
        if (most == 0) {
          EXPECT_EQ(now[session].places, was.places) << session;
        }
        for (const auto& [frame, bytes] : now[session].places) {
          ASSERT_EQ(bytes, was.places.at(frame)) << session << ", frame " << frame;
        }
      }
      const Session& killed = now[name];
      EXPECT_GE(killed.frames, lines.saved);
      // Places of frames that are not counted yet may have come along.
      const std::uint64_t end = killed.places.empty() ? 0 : killed.places.rbegin()->first + 1;
      const std::uint64_t first = most == 0 || end < most ? 0 : end - most;
      for (const std::uint64_t frame : lines.taken) {
        if (frame < first || frame >= lines.saved) continue;
        ASSERT_TRUE(killed.places.contains(frame)) << frame << " of " << lines.saved;
        ASSERT_EQ(killed.places.at(frame), whole.places.at(frame)) << frame;
      }
      if (most > 0) {
        EXPECT_LE(places, most);
      }
      if (killed.frames == 0 && killed.places.empty()) now.erase(name);
      before = std::move(now);
    }
    EXPECT_GT(acknowledged_in_all, static_cast<std::uint64_t>(times) * 10) << "it tests nothing";
  }
};

TEST_F(MapProcess, AKillLosesNothingThatWasAcknowledged) { kill_runs(1, kills / 2, 0); }

TEST_F(MapProcess, AKillLeavesNoMorePlacesThanMayBe) { kill_runs(2, kills / 2, 150); }

TEST_F(MapProcess, OfAnInterruptedMatchNothingStays) {
  write_drive("long.npy", 30'000, 64);  // ten seconds of matching
  write_drive("short.npy", 200, 64);
  const std::string one = "match --query short.npy --session one --paper --out m.csv --map ";
  ASSERT_EQ(run(one + "old.seqloop").exit_code, 0);
  for (const char* map : {"old.seqloop", "new.seqloop"}) {
    SCOPED_TRACE(map);
    Process process({SEQLOOP_BINARY, "match", "--query", file("long.npy"), "--map", file(map),
                     "--session", "two", "--save-every-s", "0.02", "--paper", "--method",
                     "seqcnnslam", "--out", file("long.csv")},
                    file("out"), file("err"));
    ASSERT_TRUE(has_frames(map, "two")) << test::read_all(file("err"));
    ::kill(process.pid(), SIGINT);
    EXPECT_EQ(process.wait(), 1);
    EXPECT_EQ(test::read_all(file("err")), "seqloop: interrupted: nothing has been written\n");
  }
  EXPECT_EQ(sessions("old.seqloop").size(), 1U);
  for (const char* name : {"new.seqloop", "long.csv", "partial"}) {
    EXPECT_EQ(listing().find(name), std::string::npos) << listing();
  }
}

TEST_F(MapProcess, AFullDiskThatHasRoomAgainTakesWhatIsMissing) {
  const auto limit = [](pid_t pid, rlim_t soft) {
    const rlimit wanted{soft, RLIM_INFINITY};
    ASSERT_EQ(::prlimit(pid, RLIMIT_FSIZE, &wanted, nullptr), 0);
  };
  Process process(drive("m.seqloop", "one", {"--fps", "400"}), "/dev/null", file("err"), [&] {
    ::signal(SIGXFSZ, SIG_IGN);
    limit(0, 300'000);
  });
  EXPECT_TRUE(says("err", "the run goes on")) << test::read_all(file("err"));
  limit(process.pid(), RLIM_INFINITY);
  EXPECT_EQ(process.wait(), 0) << test::read_all(file("err"));
  EXPECT_NE(test::read_all(file("err")).find("what was missing is saved"), std::string::npos)
      << test::read_all(file("err"));
  EXPECT_EQ(run("map check m.seqloop").exit_code, 0);
  EXPECT_GT(sessions("m.seqloop").at("one").frames, frames / 2);
}

#ifdef SEQLOOP_STALLING_DISK
TEST_F(MapProcess, ADiskThatStallsKeepsNoFrameWaiting) {
  Process process(drive("m.seqloop", "one", {"--fps", "100"}), file("lines"), file("err"),
                  [&] { use_stalling_disk(); });
  ASSERT_TRUE(says("lines", "\"saved\":2")) << test::read_all(file("err"));
  folder_.write("stall", "");
  EXPECT_TRUE(says("err", "the run goes on")) << test::read_all(file("err"));
  const Said stalled = said("lines");
  EXPECT_GT(stalled.taken.back(), stalled.saved + 100) << "two seconds of driving went by";
  std::filesystem::remove(file("stall"));
  EXPECT_EQ(process.wait(), 0) << test::read_all(file("err"));
  EXPECT_NE(test::read_all(file("err")).find("what was missing is saved"), std::string::npos)
      << test::read_all(file("err"));
  EXPECT_EQ(run("map check m.seqloop").exit_code, 0);
  EXPECT_GT(sessions("m.seqloop").at("one").frames, frames / 2);
}

TEST_F(MapProcess, AStallThatOutlastsTheDriveEndsWithAWord) {
  Process process(drive("m.seqloop", "one", {"--fps", "200"}), file("lines"), file("err"),
                  [&] { use_stalling_disk(); });
  ASSERT_TRUE(says("lines", "\"saved\":2")) << test::read_all(file("err"));
  folder_.write("stall", "");
  EXPECT_TRUE(says("lines", "\"newest\":" + std::to_string(frames - 1)));
  std::filesystem::remove(file("stall"));
  EXPECT_EQ(process.wait(), 0) << test::read_all(file("err"));
  const std::string told = test::read_all(file("err"));
  EXPECT_NE(told.find("the run goes on"), std::string::npos) << told;
  EXPECT_NE(told.find("what was missing is saved"), std::string::npos) << told;
  // All that was taken: a machine that is busy with other things may not keep up with the drive.
  const auto places = sessions("m.seqloop").at("one").places;
  EXPECT_GT(places.size(), frames / 2);
  for (const std::uint64_t frame : said("lines").taken) {
    EXPECT_TRUE(places.contains(frame)) << frame;
  }
}
#endif

}  // namespace
}  // namespace seqloop
