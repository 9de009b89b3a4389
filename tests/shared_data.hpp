// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace seqloop::test {

/// The folder with real drives and models, named by the environment variable SEQLOOP_SHARED.
/// Where it is missing, tests skip, but fail when SEQLOOP_REQUIRE_DATA is set.
inline std::optional<std::filesystem::path> shared_data() {
  const char* folder = std::getenv("SEQLOOP_SHARED");
  if (folder != nullptr && std::filesystem::is_directory(folder)) return folder;
  if (std::getenv("SEQLOOP_REQUIRE_DATA") != nullptr) {
    ADD_FAILURE() << "SEQLOOP_REQUIRE_DATA is set, but SEQLOOP_SHARED names no folder";
  }
  return std::nullopt;
}

}  // namespace seqloop::test

/// Sets FOLDER to the real data, or leaves the test.
#define SEQLOOP_DATA_OR_SKIP(FOLDER)                                                          \
  const std::optional<std::filesystem::path> FOLDER##_or_none = seqloop::test::shared_data(); \
  if (!FOLDER##_or_none) GTEST_SKIP() << "SEQLOOP_SHARED names no folder of real data";       \
  const std::filesystem::path& FOLDER = *FOLDER##_or_none
