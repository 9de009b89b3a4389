// SPDX-License-Identifier: MIT
// The real program's loop makes no system call and takes no memory for those who look at it: both
// are counted in its own thread, in a long run and a short one, so that setting up cancels out.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "core/oracle.hpp"
#include "http/client.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t few = 2'000;
constexpr std::uint64_t many = 10'000;

struct Counts {
  bool traced = false;
  int status = -1;
  std::uint64_t system_calls = 0;
  std::uint64_t allocations = 0;
};

class ServedLoop : public test::Program {
 protected:
  void SetUp() override {
    const oracle::Vectors lap = oracle::drive(11, 400, 24, 0.2F);
    write("reference.npy", lap, lap.size());
    write("query.npy", lap, many);
  }

  /// A run, whose main thread is traced: threads that it starts are not.
  Counts counted(std::uint64_t frames, bool served) {
    std::filesystem::remove(file("err.txt"));
    std::vector<std::string> words{
        SEQLOOP_BINARY,  "run",   "--source",  "query.npy", "--reference",
        "reference.npy", "--out", "run.jsonl", "--frames",  std::to_string(frames)};
    if (served) words.insert(words.end(), {"--serve", "127.0.0.1:0"});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) become(arguments);
    std::atomic<bool> over{false};
    std::array<std::thread, 2> lookers;
    for (std::thread& looker : lookers) looker = std::thread([&] { look(over); });
    Counts counts = follow(child);
    over = true;
    for (std::thread& looker : lookers) looker.join();
    const std::string text = test::read_all(file("count.txt"));
    counts.allocations = text.empty() ? 0 : std::stoull(text);
    return counts;
  }

 private:
  void write(const std::string& name, const oracle::Vectors& lap, std::size_t rows) const {
    files::NpyWriter writer(file(name), 24);
    for (std::size_t n = 0; n < rows; ++n) writer.append(lap[n % lap.size()]);
    writer.commit();
  }

  [[noreturn]] void become(const std::vector<char*>& arguments) const {
    const int err = ::open(file("err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(err, STDERR_FILENO);
    ::setenv("SEQLOOP_COUNT", file("count.txt").c_str(), 1);
    ::setenv("LD_PRELOAD", SEQLOOP_COUNTED_ALLOCATIONS, 1);
    if (::chdir(folder_.path().c_str()) != 0 || ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0)
      ::_exit(126);
    ::execv(arguments.front(), arguments.data());
    ::_exit(127);
  }

  /// Counts the system calls of a child until it ends.
  static Counts follow(pid_t child) {
    Counts counts;
    std::uint64_t stops = 0;
    int status = 0;
    while (::waitpid(child, &status, 0) == child && WIFSTOPPED(status)) {
      if (!counts.traced) {
        ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
        counts.traced = true;
      }
      const bool call = WSTOPSIG(status) == (SIGTRAP | 0x80);
      stops += call ? 1 : 0;
      const int pass_on = call || WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
      ::ptrace(PTRACE_SYSCALL, child, nullptr, pass_on);
    }
    counts.system_calls = stops / 2;  // at its beginning, and at its end
    counts.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return counts;
  }

  /// As a page does, all the time.
  void look(const std::atomic<bool>& over) const {
    const std::string sign = "serving on http://127.0.0.1:";
    std::string said;
    while (!over && (said.find(sign) == std::string::npos || said.back() != '\n')) {
      std::this_thread::sleep_for(1ms);
      said = test::read_all(file("err.txt"));
    }
    if (over) return;
    const auto port =
        static_cast<std::uint16_t>(std::stoi(said.substr(said.find(sign) + sign.size())));
    http::test::Client events(port);
    events.send("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    while (!over) {
      http::test::Client asks(port);
      bool complete = false;
      if (!asks.send("GET /api/history HTTP/1.1\r\nHost: localhost\r\n\r\n")) return;
      static_cast<void>(asks.reply(complete, 200));
    }
  }
};

TEST_F(ServedLoop, MakesNoSystemCallAndTakesNoMemoryForThoseWhoLook) {
  const Counts short_alone = counted(few, false);
  if (!short_alone.traced || short_alone.status == 126)
    GTEST_SKIP() << "nothing may be traced here";
  ASSERT_EQ(short_alone.status, 0) << test::read_all(file("err.txt"));
  const Counts long_alone = counted(many, false);
  const Counts short_served = counted(few, true);
  const Counts long_served = counted(many, true);
  ASSERT_EQ(long_served.status, 0) << test::read_all(file("err.txt"));
  const auto more = [](std::uint64_t more_frames, std::uint64_t fewer_frames) {
    return static_cast<std::int64_t>(more_frames) - static_cast<std::int64_t>(fewer_frames);
  };
  const std::int64_t calls = more(long_alone.system_calls, short_alone.system_calls);
  const std::int64_t calls_served = more(long_served.system_calls, short_served.system_calls);
  const std::int64_t taken = more(long_alone.allocations, short_alone.allocations);
  const std::int64_t taken_served = more(long_served.allocations, short_served.allocations);
  std::printf("%d frames more: %d system calls and %d allocations; served %d and %d\n",
              static_cast<int>(many - few), static_cast<int>(calls), static_cast<int>(taken),
              static_cast<int>(calls_served), static_cast<int>(taken_served));
  EXPECT_GT(calls, 100) << "the lines are written: the counter sees that";
  // Numbers of other lengths make a block of lines more or less.
  constexpr std::int64_t a_hundredth = static_cast<std::int64_t>(many - few) / 100;
  EXPECT_LT(calls_served, calls + a_hundredth);
  EXPECT_LT(taken_served, taken + a_hundredth);
}

}  // namespace
}  // namespace seqloop
