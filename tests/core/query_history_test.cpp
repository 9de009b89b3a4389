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

TEST(MovedQueries, AreComparedByWhatTheyWereMovedTo) {
  TestArena memory;
  const DescriptorForm form(paper(Candidates::all, 2), size);
  const auto in = [](const DescriptorRows& rows, std::size_t row) {
    std::vector<float> out(rows.restored_size());
    rows.restore(row, out);
    out.resize(size);
    return out;
  };
  const std::vector<float> as_it_came{1.0F, 2.0F, 3.0F};
  const std::vector<float> moved{2.0F, 3.0F, 3.0F};
  QueryHistory queries(memory.arena, form, kept, true);
  for (std::uint64_t frame = 0; frame < 3 * kept; ++frame) {
    const bool moves = frame % 3 != 0;
    queries.push(as_it_came, moves ? moved : as_it_came);
    queries.push_again();
    for (const std::uint64_t at : {queries.newest() - 1, queries.newest()}) {
      EXPECT_EQ(in(queries.rows(), queries.row_of(at)), as_it_came);
      EXPECT_EQ(in(queries.moved(), queries.row_of(at)), moves ? moved : as_it_came);
    }
  }
  QueryHistory never(memory.arena, form, kept);
  never.push(as_it_came, moved);
  EXPECT_EQ(&never.moved(), &never.rows());
  EXPECT_EQ(in(never.moved(), never.row_of(0)), as_it_came);
}

}  // namespace
}  // namespace seqloop
