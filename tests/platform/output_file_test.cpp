// SPDX-License-Identifier: MIT
#include "seqloop/files/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "expect_setup_error.hpp"
#include "temporary_folder.hpp"

namespace seqloop::files {
namespace {

using test::read_all;
using test::says;
using test::setup_error;
using test::TemporaryFolder;

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

std::string open_error(const std::filesystem::path& path) {
  return setup_error([&] { OutputFile file(path); });
}

TEST(OutputFile, AppearsCompleteAtCommit) {
  const TemporaryFolder folder;
  const auto path = folder.write("out.csv", "old");
  OutputFile file(path);
  file.write("first\n");
  file.flush();
  EXPECT_EQ(read_all(path), "old");
  file.write("second\n");
  file.commit();
  EXPECT_EQ(read_all(path), "first\nsecond\n");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputFile, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  {
    OutputFile file(folder.path() / "out.csv");
    file.write("half");
    file.flush();
    EXPECT_EQ(entries(folder.path()), 1U);
  }
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(OutputFile, KeepsEveryByteOfWritesLargerThanItsBuffer) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 40'000; ++i) text += std::to_string(i) + ',';
  OutputFile file(folder.path() / "out");
  file.write("head");
  file.write(text);
  file.overwrite_start(std::as_bytes(std::span("HEAD", 4)));
  file.write("tail");
  file.commit();
  EXPECT_EQ(read_all(folder.path() / "out"), "HEAD" + text + "tail");
}

TEST(OutputFile, TwoAtOnceDoNotShareAFile) {
  const TemporaryFolder folder;
  OutputFile first(folder.path() / "out");
  OutputFile second(folder.path() / "out");
  first.write("1");
  second.write("2");
  second.commit();
  first.commit();
  EXPECT_EQ(read_all(folder.path() / "out"), "1");
}

// What a killed process leaves behind has the name, and nobody holds it.
TEST(OutputFile, RemovesWhatAKilledProcessLeftOfTheSameOutput) {
  const TemporaryFolder folder;
  // Its number may be in use again, even by this process.
  const std::string own = ".out.partial-" + std::to_string(::getpid());
  const std::vector<std::string> left{".out.partial-1", ".out.partial-99999999-3", own};
  const std::vector<std::string> others{".out.partial-",     ".out.partial-12x",   "out.partial-12",
                                        ".out.partial-1-2-", ".out.csv.partial-5", "out"};
  for (const std::string& name : left) folder.write(name, "half");
  for (const std::string& name : others) folder.write(name, "theirs");
  std::filesystem::create_directory(folder.path() / ".out.partial-7");
  std::filesystem::create_symlink("out", folder.path() / ".out.partial-8");
  const OutputFile file(folder.path() / "out");
  for (const std::string& name : {left[0], left[1]}) {
    EXPECT_FALSE(std::filesystem::exists(folder.path() / name)) << name;
  }
  for (const std::string& name : others) {
    EXPECT_EQ(read_all(folder.path() / name), "theirs") << name;
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path() / ".out.partial-7"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / ".out.partial-8"));
  EXPECT_EQ(entries(folder.path()), others.size() + 3U);
}

TEST(OutputFile, LeavesAloneWhatALivingProcessWrites) {
  const TemporaryFolder folder;
  std::array<int, 2> told{};
  ASSERT_EQ(::pipe(told.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const OutputFile file(folder.path() / "out");
    (void)::write(told[1], "x", 1);
    ::pause();
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(told[0], &byte, 1), 1);
  { const OutputFile file(folder.path() / "out"); }
  remove_abandoned(folder.path());
  EXPECT_EQ(entries(folder.path()), 1U) << "the child's";
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  folder.write(".other.partial-4", "half");
  folder.write("other", "whole");
  remove_abandoned(folder.path());
  EXPECT_EQ(entries(folder.path()), 1U);
  EXPECT_EQ(read_all(folder.path() / "other"), "whole");
  for (const int end : told) ::close(end);
}

TEST(OutputFile, StaysAsPrivateAsItWas) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("secret", "old");
  std::filesystem::permissions(path, std::filesystem::perms{0600});
  OutputFile file(path);
  file.write("new");
  file.commit();
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0600});
}

TEST(OutputFile, RefusesALinkToNowhere) {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink(folder.path() / "none", folder.path() / "link");
  EXPECT_TRUE(test::says(test::setup_error([&] { const OutputFile file(folder.path() / "link"); }),
                         "leads nowhere"));
}

TEST(OutputFile, ReplacesWhatALinkPointsTo) {
  const TemporaryFolder folder;
  const auto target = folder.write("target", "old");
  std::filesystem::create_symlink(target, folder.path() / "link");
  OutputFile file(folder.path() / "link");
  file.write("new");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link"));
  EXPECT_EQ(read_all(target), "new");
}

TEST(OutputFile, WritesDevicesDirectly) {
  OutputFile null("/dev/null");
  null.write("gone");
  null.commit();
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

// Bad input: a disk that is full.
TEST(OutputFile, FullDiskIsAnIoErrorThatSaysSo) {
  OutputFile full("/dev/full");
  full.write("text");
  try {
    full.commit();
    FAIL() << "no IoError";
  } catch (const IoError& error) {
    EXPECT_TRUE(says(error.what(), "/dev/full: cannot be written: No space left on device"));
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

// Bad input: names that cannot be written.
TEST(OutputFile, RefusesNamesThatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto file = folder.write("file", "");
  EXPECT_TRUE(
      says(open_error(folder.path() / "none" / "out"), "its folder does not exist; create"));
  EXPECT_TRUE(says(open_error(folder.path()), "is a folder"));
  EXPECT_TRUE(says(open_error(file / "out"), "is not a folder"));
  EXPECT_TRUE(says(open_error(""), "names no file"));
  EXPECT_TRUE(says(open_error(folder.path() / std::string(300, 'x')), "cannot be created"));
  EXPECT_EQ(entries(folder.path()), 1U);
}

// Bad input: a folder and a file without write permission.
TEST(OutputFile, RefusesWhatMayNotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TemporaryFolder folder;
  const auto file = folder.write("protected", "old");
  ::chmod(file.c_str(), 0444);
  EXPECT_TRUE(says(open_error(file), "may not be written"));
  ::chmod(folder.path().c_str(), 0555);
  EXPECT_TRUE(says(open_error(folder.path() / "new"), "cannot be created"));
  ::chmod(folder.path().c_str(), 0755);
}

}  // namespace
}  // namespace seqloop::files
