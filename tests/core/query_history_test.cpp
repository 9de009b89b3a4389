// SPDX-License-Identifier: MIT
// A ring of descriptors: which frame is where, before and after it wraps.
#include "seqloop/detail/query_history.hpp"

#include "core/matcher.hpp"

namespace seqloop {
namespace {

constexpr std::size_t size = 3;
constexpr std::size_t kept = 4;

class Queries : public testing::Test {
 protected:
  std::vector<float> at(std::uint64_t frame) const {
    std::vector<float> out(queries_.rows().restored_size());
    queries_.rows().restore(queries_.row_of(frame), out);
    out.resize(size);
    return out;
  }

  TestArena memory_;
  QueryHistory queries_{memory_.arena, DescriptorForm(paper(Candidates::all, 2), size), kept};
};

TEST_F(Queries, KeepTheNewestAfterWrappingTwice) {
  for (std::uint64_t frame = 0; frame < 2 * kept + 1; ++frame) {
    EXPECT_EQ(queries_.frames(), frame);
    queries_.push(std::vector<float>{static_cast<float>(frame), 1.0F, 0.0F});
    EXPECT_EQ(queries_.newest(), frame);
    for (std::uint64_t f = frame < kept ? 0 : frame - kept + 1; f <= frame; ++f) {
      EXPECT_EQ(at(f), (std::vector<float>{static_cast<float>(f), 1.0F, 0.0F}));
      EXPECT_NEAR(queries_.between(f, frame), static_cast<double>(frame - f), 1e-6);
    }
  }
}

TEST_F(Queries, AFrameWithoutADescriptorRepeatsTheOneBefore) {
  queries_.push_again();
  EXPECT_EQ(at(0), (std::vector<float>{0.0F, 0.0F, 0.0F})) << "there is none before";
  queries_.push(std::vector<float>{1.0F, 2.0F, 3.0F});
  for (std::uint64_t frame = 2; frame < 2 * kept; ++frame) {
    queries_.push_again();
    EXPECT_EQ(at(frame), (std::vector<float>{1.0F, 2.0F, 3.0F}));
  }
}

}  // namespace
}  // namespace seqloop
