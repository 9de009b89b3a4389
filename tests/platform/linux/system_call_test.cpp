// SPDX-License-Identifier: MIT
// The match stage asks nothing of the system: a process that is killed for any system call lives.
#include <gtest/gtest.h>

#include <csignal>
#include <cstddef>

#include "core/matcher.hpp"
#include "without_system_calls.hpp"

namespace seqloop::live {
namespace {

using seqloop::test::status_without_system_calls;

class SystemCalls : public testing::Test {
 protected:
  void SetUp() override {
    if (const char* const why = seqloop::test::system_calls_cannot_be_forbidden())
      GTEST_SKIP() << why;
    ASSERT_EQ(status_without_system_calls([] { return true; }), 0);
  }
};

TEST_F(SystemCalls, TheFilterKillsForASingleOne) {
  const int status = status_without_system_calls([] { return syscall(SYS_getppid) >= 0; });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGSYS);
}

TEST_F(SystemCalls, NoStepOfTheDetectorMakesOne) {
  const oracle::Vectors lap = oracle::drive(31, 150, 40, 0.2F);
  for (const Candidates candidates : {Candidates::all, Candidates::ranges, Candidates::adaptive}) {
    for (const Use use : {Use::localise, Use::close_loops}) {
      MatcherConfig config;
      config.candidates = candidates;
      config.use = use;
      config.exclude = 30;
      PlaceMap map = use == Use::localise ? map_of(lap, config) : PlaceMap(config, {600, 40});
      Detector detector(config, map);
      EXPECT_EQ(status_without_system_calls([&] {
                  std::size_t matched = 0;
                  for (std::size_t frame = 0; frame < 500; ++frame) {
                    matched += detector.step(lap[frame % lap.size()]).match.has_value();
                    if (frame % 50 == 0) detector.skip(frame % 100 == 0 ? 2 : 1000);
                  }
                  return matched > 100;
                }),
                0);
    }
  }
}

}  // namespace
}  // namespace seqloop::live
