// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "temporary_folder.hpp"

namespace seqloop::test {

/// How the program ended.
struct Outcome {
  int exit_code;
  std::string out;
  std::string err;
};

/// Runs the real binary through a shell, in a folder of its own.
class Program : public testing::Test {
 protected:
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    const std::string out = file("stdout.txt");
    const std::string err = file("stderr.txt");
    const std::string command = "cd '" + folder_.path().string() + "' && { '" SEQLOOP_BINARY "' " +
                                arguments + "; } >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_all(out), read_all(err)};
  }

  [[nodiscard]] std::string file(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(file(name));
  }

  /// Names of what is in the folder, hidden files too, without the program's own words.
  [[nodiscard]] std::string listing() const {
    std::string names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with("std")) names += name + ' ';
    }
    return names;
  }

  TemporaryFolder folder_;
};

}  // namespace seqloop::test
