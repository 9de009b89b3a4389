// SPDX-License-Identifier: MIT
// The order of places against a plain list.
#include <algorithm>
#include <random>
#include <set>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

struct Place {
  std::size_t slot;
  std::uint64_t number;
};

void expect_equal(const PlaceOrder& order, const std::vector<Place>& list) {
  ASSERT_EQ(order.size(), list.size());
  std::set<std::size_t> slots;
  for (std::size_t row = 0; row < list.size(); ++row) {
    ASSERT_EQ(order.slot(row), list[row].slot) << row;
    ASSERT_EQ(order.number(row), list[row].number) << row;
    ASSERT_LT(order.slot(row), order.capacity());
    slots.insert(order.slot(row));
  }
  ASSERT_EQ(slots.size(), list.size()) << "no two rows in one slot";
}

void expect_pieces_cover(const PlaceOrder& order, std::size_t first, std::size_t last) {
  std::size_t next = first;
  std::size_t behind_the_last_piece = order.capacity() + 1;
  order.in_slots(first, last, [&](std::size_t row, std::size_t slot, std::size_t count) {
    ASSERT_EQ(row, next);
    ASSERT_GT(count, 0U);
    ASSERT_NE(slot, behind_the_last_piece) << "pieces are as long as can be";
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(order.slot(row + i), slot + i);
    next = row + count;
    behind_the_last_piece = slot + count;
  });
  ASSERT_EQ(next, std::max(first, last));
}

TEST(PlaceOrder, EqualsAListWhoeverGoes) {
  for (const std::size_t capacity : {1U, 2U, 3U, 16U, 61U}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE("capacity " + std::to_string(capacity) + ", seed " + std::to_string(seed));
      TestArena memory;
      PlaceOrder order(memory.arena, capacity, 1);
      std::vector<Place> list;
      std::mt19937 random(seed);
      // Of seed 1 the oldest always goes, of seed 2 the newest; of the others any.
      const auto row_to_go = [&]() -> std::size_t {
        if (seed == 1) return 0;
        return seed == 2 ? list.size() - 1 : random() % list.size();
      };
      for (std::uint64_t number = 0; number < 500; ++number) {
        if (list.size() == capacity || (seed == 5 && !list.empty() && random() % 4 == 0)) {
          const std::size_t row = row_to_go();
          ASSERT_EQ(order.remove(row), list[row].slot);
          list.erase(list.begin() + static_cast<std::ptrdiff_t>(row));
          ASSERT_NO_FATAL_FAILURE(expect_equal(order, list));
        }
        list.push_back({order.append(number), number});
        ASSERT_NO_FATAL_FAILURE(expect_equal(order, list));
        const std::size_t first = random() % (list.size() + 1);
        ASSERT_NO_FATAL_FAILURE(expect_pieces_cover(order, first, list.size()));
        ASSERT_NO_FATAL_FAILURE(expect_pieces_cover(order, 0, first));
      }
    }
  }
}

TEST(PlaceOrder, ASessionThatHasNoPlaceYetTakesNoneOfTheOneBeforeIt) {
  TestArena memory;
  PlaceOrder order(memory.arena, 10, 2);
  order.append(0, 0);
  order.count_from(100);
  ASSERT_TRUE(order.begin_session());
  order.insert(0, 1, 1);
  EXPECT_EQ(order.session(0).last, 2U);
  EXPECT_EQ(order.session(1).first, 2U);
  EXPECT_EQ(order.session(1).last, 2U);
  EXPECT_EQ(order.next_number(), 100U);
  EXPECT_EQ(order.session_of_number(1), 0U);
  order.append(0);
  EXPECT_EQ(order.session(1).last, 3U);
  EXPECT_EQ(order.number(2), 100U);
}

TEST(PlaceOrder, IsStraightUntilAPlaceGoes) {
  TestArena memory;
  PlaceOrder order(memory.arena, 3, 1);
  for (std::size_t slot = 0; slot < 3; ++slot) EXPECT_EQ(order.append(slot), slot);
  EXPECT_TRUE(order.straight());
  EXPECT_EQ(order.remove(1), 1U);
  EXPECT_FALSE(order.straight());
  EXPECT_EQ(order.append(3), 1U) << "the room of the place that went";
  EXPECT_EQ(order.number(2), 3U);
}

}  // namespace
}  // namespace seqloop
