// SPDX-License-Identifier: MIT
#include "files/output_folder.hpp"

#include <gtest/gtest.h>

#include "expect_setup_error.hpp"
#include "temporary_folder.hpp"

namespace seqloop::files {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(OutputFolder, AppearsOnlyWhenItIsComplete) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  {
    OutputFolder out(target);
    out.write("a.txt", "first");
    out.write("a.txt", "a");
    out.write("b.txt", "");
    EXPECT_FALSE(fs::exists(target));
    out.commit();
  }
  EXPECT_EQ(entries(folder.path()), 1U);
  EXPECT_EQ(entries(target), 2U);
  EXPECT_EQ(test::read_all(target / "a.txt"), "a");
}

TEST(OutputFolder, WithoutACommitNothingIsLeft) {
  const test::TemporaryFolder folder;
  {
    OutputFolder out(folder.path() / "out");
    out.write("a.txt", "a");
    EXPECT_THROW(out.write("none/a.txt", "a"), IoError);
    EXPECT_EQ(entries(folder.path()), 1U);
  }
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(OutputFolder, TakesThePlaceOfAnEmptyFolderAndItsPermissions) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "real");
  fs::permissions(folder.path() / "real", fs::perms::owner_all);
  fs::create_directory_symlink("real", folder.path() / "link");
  OutputFolder out(folder.path() / "link/");
  out.write("a.txt", "a");
  out.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_TRUE(fs::exists(folder.path() / "real/a.txt"));
  EXPECT_EQ(fs::status(folder.path() / "real").permissions(), fs::perms::owner_all);
}

TEST(OutputFolder, SaysWhyItCannotBeMade) {
  const test::TemporaryFolder folder;
  folder.write("file", "");
  fs::create_symlink("nowhere", folder.path() / "dangling");
  const auto refused = [&](const fs::path& path) {
    return test::setup_error([&] { const OutputFolder out(path); });
  };
  EXPECT_TRUE(test::says(refused(folder.path()), "no empty folder"));
  EXPECT_TRUE(test::says(refused(folder.path() / "file"), "no empty folder"));
  EXPECT_TRUE(test::says(refused(folder.path() / "dangling"), "no empty folder"));
  EXPECT_TRUE(test::says(refused(folder.path() / "none/out"), "does not exist"));
  EXPECT_TRUE(test::says(refused(folder.path() / "file/out"), "does not exist"));
  EXPECT_TRUE(test::says(refused(""), "names no folder"));
  EXPECT_TRUE(test::says(refused("/"), "names no folder"));
  EXPECT_TRUE(test::says(refused("/proc/out"), "cannot be created"));
}

TEST(OutputFolder, RemovesWhatAKilledProcessLeftOfTheSameFolder) {
  const test::TemporaryFolder folder;
  for (const char* name : {".out.partial-1", ".out.partial-2-1", ".else.partial-1"}) {
    fs::create_directory(folder.path() / name);
    folder.write(std::string(name) + "/000000.png", "half");
  }
  folder.write(".out.partial-3", "a file");
  OutputFolder first(folder.path() / "out");
  const OutputFolder second(folder.path() / "out");
  EXPECT_EQ(entries(folder.path()), 4U) << "two others', and the two that are at work";
  EXPECT_TRUE(fs::exists(folder.path() / ".else.partial-1/000000.png"));
  EXPECT_TRUE(fs::exists(folder.path() / ".out.partial-3"));
  first.write("a.txt", "a");
  first.commit();
  EXPECT_TRUE(fs::exists(folder.path() / "out/a.txt"));
}

TEST(OutputFolder, DoesNotReplaceWhatCameMeanwhile) {
  const test::TemporaryFolder folder;
  {
    OutputFolder out(folder.path() / "out");
    out.write("a.txt", "mine");
    fs::create_directory(folder.path() / "out");
    folder.write("out/a.txt", "theirs");
    EXPECT_THROW(out.commit(), IoError);
  }
  EXPECT_EQ(entries(folder.path()), 1U);
  EXPECT_EQ(test::read_all(folder.path() / "out/a.txt"), "theirs");
}

}  // namespace
}  // namespace seqloop::files
