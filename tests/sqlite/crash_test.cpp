// SPDX-License-Identifier: MIT
// Maps whose writer is killed, or whose disk loses power, after every single write, truncation,
// sync and removal of a run.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <random>

#include "expect_setup_error.hpp"
#include "sqlite/recording_vfs.hpp"
#include "sqlite/sample_map.hpp"
#include "temporary_folder.hpp"

namespace seqloop {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;

constexpr bool all = SEQLOOP_ALL_CRASHES;  // else as much as fits among the unit tests
using test::Disk;

/// A run of several sessions, and what the map held after each call that returned.
class RecordedRun {
 public:
  explicit RecordedRun(const fs::path& folder) : folder_(folder) {}

  void drive(std::size_t sessions, std::size_t batches) {
    for (std::size_t s = 0; s < sessions; ++s) {
      MapFile map = MapFile::open(file(), test::sample_form());
      acknowledged(map);
      const std::int64_t id = map.begin_session("drive " + std::to_string(s), 1, "k = 10");
      acknowledged(map);
      for (std::size_t b = 0; b < batches; ++b) {
        std::vector<std::uint64_t> removed;
        const std::uint64_t next = map.next_place();
        if (b % 2 == 1) removed = {next / 2, next / 3, next - 1};
        test::save_sample(map, id, 30 * b, 5 + 10 * (b % 3), removed);
        acknowledged(map);
      }
      if (s == 0) grow_side_by_side(map, batches);
      if (s == 1) forget(map, "drive 0");
      if (s == 2) merge(map);
      if (s == 3) retire(map, "drive 2");
      if (s % 2 == 1) {
        map.compact();
        acknowledged(map);
      }
    }
  }

  [[nodiscard]] fs::path file() const { return folder_ / "map.seqloop"; }
  [[nodiscard]] const std::vector<test::FileEvent>& log() const { return vfs_.log; }
  [[nodiscard]] const std::string& content(std::int64_t number) const {
    return contents_[static_cast<std::size_t>(number)];
  }
  void lose_syncs() { vfs_.syncs_reach_the_disk = false; }
  [[nodiscard]] std::int64_t newest() const {
    return static_cast<std::int64_t>(contents_.size()) - 1;
  }

 private:
  void acknowledged(const MapFile& map) {
    std::string fault;
    contents_.push_back(test::content_of(map, fault));
    EXPECT_EQ(fault, "");
    vfs_.say(newest());
  }

  /// Sessions of several robots, a batch of each in turn.
  void grow_side_by_side(MapFile& map, std::size_t batches) {
    const std::uint64_t first = map.next_place();
    std::array<std::int64_t, 3> ids{};
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = map.begin_session("robot " + std::to_string(i), 1, "");
      acknowledged(map);
    }
    for (std::size_t b = 0; b < batches; ++b) {
      for (std::size_t i = 0; i < ids.size(); ++i) {
        test::save_sample(map, ids[i], 30 * b, 5 + b, {}, first + 1000 * i + 30 * b);
        acknowledged(map);
      }
    }
  }

  void forget(MapFile& map, const std::string& name) {
    map.forget(name);
    acknowledged(map);
  }

  void retire(MapFile& map, const std::string& name) {
    std::vector<sqlite::Successor> successors;
    const std::uint64_t end = map.next_place();
    for (std::uint64_t place = 0; place < end; place += 2) {
      successors.push_back({place, end - 1, .75});
    }
    EXPECT_GT(map.retire(name, 7, end, successors, 3), 0U);
    acknowledged(map);
  }

  void merge(MapFile& map) {
    const fs::path other = folder_ / "other.seqloop";
    {
      MapFile made = MapFile::open(other, test::sample_form());
      for (const char* name : {"drive 1", "elsewhere"}) {
        const std::int64_t id = made.begin_session(name, 5, "");
        test::save_sample(made, id, 0, 12);
      }
    }
    map.add(MapFile::read_only(other));
    acknowledged(map);
  }

  fs::path folder_;
  test::RecordingVfs vfs_{"map.seqloop"};
  std::vector<std::string> contents_{""};  // before there was a map
};

fs::path in_memory() {
  return fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
}

struct Losses {
  std::size_t images = 0;
  std::size_t unopened = 0;
  std::size_t lost = 0;
  std::size_t halves = 0;
  std::string first;
};

/// Looks at one image. @param low, high what may be in it: the newest that was acknowledged, and
/// what was being saved
void look(const test::DiskImage& image, const RecordedRun& run, std::int64_t low, std::int64_t high,
          const std::string& when, Losses& losses) {
  const test::TemporaryFolder folder(in_memory());
  for (const auto& [name, bytes] : image) {
    std::ofstream(folder.path() / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  ++losses.images;
  std::string found;
  std::string fault;
  const fs::path file = folder.path() / "map.seqloop";
  try {
    if (fs::exists(file) && fs::file_size(file) > 0) {
      found = test::content_of(MapFile::open(file, std::nullopt), fault);
    } else {
      (void)MapFile::open(file, test::sample_form());  // who made it may begin anew
    }
  } catch (const SetupError& error) {
    // A map whose making was cut short is empty, and says so.
    if (low > 0 || std::string(error.what()).find("is empty") == std::string::npos) {
      fault = error.what();
    }
  }
  std::size_t* count = nullptr;
  if (!fault.empty()) {
    count = &losses.unopened;
  } else if (found != run.content(low) && found != run.content(high)) {
    bool older = false;
    for (std::int64_t i = 0; i < low; ++i) older = older || found == run.content(i);
    count = older ? &losses.lost : &losses.halves;
  }
  if (count == nullptr) return;
  ++*count;
  if (losses.first.empty()) losses.first = when + ": " + fault;
}

/// Ends a run after each event in each way. @param seeds of chance @param every event looked at
Losses end_everywhere(const RecordedRun& run, std::uint64_t seeds, std::size_t every) {
  const test::RecordingVfs fast("nothing");  // syncs of what is looked at need not reach a disk
  Losses losses;
  Disk disk;
  std::int64_t newest = 0;
  for (std::size_t i = 0; i < run.log().size(); ++i) {
    const test::FileEvent& event = run.log()[i];
    disk.apply(event);
    if (event.what == test::FileEvent::What::said) newest = event.at;
    if (i % every != 0) continue;
    const std::int64_t next = std::min(newest + 1, run.newest());
    const auto end = [&](Disk::End how, std::uint64_t seed) {
      look(disk.after(how, seed), run, newest, next,
           "event " + std::to_string(i) + ", end " + std::to_string(static_cast<int>(how)) +
               ", seed " + std::to_string(seed),
           losses);
    };
    end(Disk::End::process, 0);
    end(Disk::End::power_keeps_synced, 0);
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      end(Disk::End::power_keeps_some, seed * 1'000'003 + i);
      end(Disk::End::power_tears, seed * 1'000'003 + i);
    }
  }
  std::printf("%zu images: %zu do not open, %zu lost what was acknowledged, %zu hold a half\n",
              losses.images, losses.unopened, losses.lost, losses.halves);
  return losses;
}

TEST(MapCrash, NothingAcknowledgedIsLostWhereverPowerIsCut) {
  const test::TemporaryFolder folder(in_memory());
  RecordedRun run(folder.path());
  run.drive(all ? 8 : 4, all ? 10 : 3);
  const Losses losses = end_everywhere(run, all ? 3 : 1, all ? 1 : 5);
  EXPECT_EQ(losses.unopened, 0U) << losses.first;
  EXPECT_EQ(losses.lost, 0U) << losses.first;
  EXPECT_EQ(losses.halves, 0U) << losses.first;
  EXPECT_GE(losses.images, all ? 10'000U : 100U);
}

TEST(MapCrash, WithoutSyncsThisTestFindsLosses) {
  const test::TemporaryFolder folder(in_memory());
  RecordedRun run(folder.path());
  run.lose_syncs();
  run.drive(2, all ? 10 : 4);
  const Losses losses = end_everywhere(run, 1, all ? 1 : 7);
  EXPECT_GT(losses.unopened + losses.lost + losses.halves, losses.images / 4);
}

/// Writes for ever, and says after each call that returned what the map holds since.
[[noreturn]] void write_until_killed(const fs::path& file, std::uint64_t seed, int pipe) {
  std::mt19937_64 random(seed);
  MapFile map = MapFile::open(file, test::sample_form());
  const std::int64_t id = map.begin_session("run " + std::to_string(seed), 0, "");
  for (std::uint64_t batch = 0;; ++batch) {
    const std::uint64_t next = map.next_place();
    std::vector<std::uint64_t> removed;
    if (batch % 3 == 2) removed = {random() % next, random() % next};
    const std::uint64_t frames = batch * 4;
    test::save_sample(map, id, frames, 3, removed);
    if (batch % 40 == 39) map.compact();
    const std::uint64_t saved = frames + 4;
    if (::write(pipe, &saved, sizeof saved) != sizeof saved) ::_exit(1);
  }
}

void kill_and_look(const fs::path& file, std::uint64_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    try {
      write_until_killed(file, seed, ends[1]);
    } catch (...) {
      ::_exit(2);
    }
  }
  ::close(ends[1]);
  std::mt19937_64 random(seed);
  ::usleep(static_cast<useconds_t>(random() % 30'000));
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "ended by itself: " << WEXITSTATUS(status);
  std::uint64_t acknowledged = 0;
  for (std::uint64_t saved = 0; ::read(ends[0], &saved, sizeof saved) == sizeof saved;) {
    acknowledged = saved;
  }
  ::close(ends[0]);
  const MapFile map = MapFile::open(file, test::sample_form());
  std::string fault;
  (void)test::content_of(map, fault);
  EXPECT_EQ(fault, "");
  const std::vector<sqlite::SessionFacts> sessions = map.sessions();
  std::uint64_t frames = 0;
  if (!sessions.empty() && sessions.back().name == "run " + std::to_string(seed)) {
    frames = sessions.back().frames;
  }
  EXPECT_GE(frames, acknowledged);
  EXPECT_LE(frames, acknowledged + 4);
  map.read([](const sqlite::PlaceBlock& block) {
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(block.places.subspan(i * 200, 200),
                                     test::sample_place(block.records[i].number)));
    }
  });
}

TEST(MapCrash, NothingAcknowledgedIsLostByKilling) {
  constexpr std::uint64_t times_a_map = 20;
  for (std::uint64_t maps = 0; maps < (all ? 50 : 1); ++maps) {
    const test::TemporaryFolder folder;
    for (std::uint64_t i = 0; i < times_a_map && !testing::Test::HasFailure(); ++i) {
      kill_and_look(folder.path() / "map.seqloop", maps * times_a_map + i);
    }
  }
}

}  // namespace
}  // namespace seqloop
