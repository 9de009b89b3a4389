// SPDX-License-Identifier: MIT
// What the rule's own numbers leave of Nordland, looked at picture by picture once.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/run/leave_out.hpp"
#include "seqloop/opencv/image_folder_source.hpp"
#include "shared_data.hpp"

namespace seqloop::experiment {
namespace {

TEST(LeaveOutData, NordlandLosesItsTunnelsAndHalts) {
  SEQLOOP_DATA_OR_SKIP(shared);
  opencv::ImageFolderSource summer(shared / "data/nordland_64x32/summer", false);
  opencv::ImageFolderSource winter(shared / "data/nordland_64x32/winter", false);
  const KeptFrames kept = leave_out(summer, winter, {});
  EXPECT_EQ(kept.frames.size(), 1994U);
  EXPECT_EQ(kept.dark, 135U);
  EXPECT_EQ(kept.standing, 271U);
  const auto stays = [&](std::uint64_t frame) {
    return std::ranges::binary_search(kept.frames, frame);
  };
  for (const std::uint64_t tunnel : {1192U, 1240U, 2230U}) EXPECT_FALSE(stays(tunnel)) << tunnel;
  for (const std::uint64_t halt : {150U, 255U, 722U}) EXPECT_FALSE(stays(halt)) << halt;
  for (const std::uint64_t open : {601U, 626U, 729U, 1104U}) EXPECT_TRUE(stays(open)) << open;
}

}  // namespace
}  // namespace seqloop::experiment
