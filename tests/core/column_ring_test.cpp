// SPDX-License-Identifier: MIT
// The ring of columns against a table of everything that was ever computed.
#include "seqloop/detail/column_ring.hpp"

#include <map>
#include <random>

#include "core/matcher.hpp"

namespace seqloop {
namespace {

template <class Value>
class ColumnRingOf : public testing::Test {};

using Values = testing::Types<float, std::uint16_t>;
TYPED_TEST_SUITE(ColumnRingOf, Values);

/// What the ring should hold, by frame and row.
template <class Value>
using Table = std::map<std::pair<std::uint64_t, std::size_t>, Value>;

TYPED_TEST(ColumnRingOf, EqualsATableWhateverIsAsked) {
  using Value = TypeParam;
  for (const std::size_t columns : {1U, 2U, 3U, 21U}) {
    for (const std::size_t rows : {1U, 63U, 64U, 65U, 300U}) {
      for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("columns " + std::to_string(columns) + ", rows " + std::to_string(rows) +
                     ", seed " + std::to_string(seed));
        TestArena memory;
        ColumnRing<Value> ring(memory.arena, "values", "marks", columns, rows, 3);
        Table<Value> table;
        std::mt19937 random(seed);
        Value next = 0;
        // Frames follow each other far beyond the ring's length, so that it wraps several times.
        for (std::uint64_t frame = 0; frame < 5 * columns + 3; ++frame) {
          if (frame > 0 && columns > 1 && random() % 3 == 0) {
            ring.repeat(frame);
            for (std::size_t row = 0; row < rows; ++row) {
              const auto before = table.find({frame - 1, row});
              if (before != table.end()) table[{frame, row}] = before->second;
            }
          }
          for (int act = 0; act < 12; ++act) {
            const std::uint64_t back = random() % std::min<std::uint64_t>(columns, frame + 1);
            const std::uint64_t of = frame - back;
            if (random() % 8 == 0) {
              const std::size_t row = random() % rows;
              ring.forget(row);
              for (std::uint64_t f = 0; f <= frame; ++f) table.erase({f, row});
              continue;
            }
            const std::size_t first = random() % 3 == 0 ? 0 : random() % rows;
            const std::size_t last = std::min(rows, first + random() % 150);
            std::size_t wanted = 0;
            for (std::size_t row = first; row < last; ++row) wanted += !table.contains({of, row});
            ASSERT_EQ(ring.missing(of, first, last), wanted);
            const std::size_t computed =
                ring.fill(of, first, last, [&](std::size_t row, std::span<Value> out) {
                  for (Value& value : out) {
                    ASSERT_FALSE(table.contains({of, row})) << "computed twice";
                    next = next == Value{60'000} ? Value{0} : static_cast<Value>(next + 1);
                    table[{of, row++}] = value = next;
                  }
                });
            ASSERT_EQ(computed, wanted);
            ASSERT_EQ(ring.missing(of, first, last), 0U);
            for (std::size_t row = first; row < last; ++row) {
              ASSERT_EQ(ring.column(of)[row], (table.at({of, row})));
            }
          }
          for (std::uint64_t of = frame - std::min<std::uint64_t>(frame, columns - 1); of <= frame;
               ++of) {
            for (std::size_t row = 0; row < rows; ++row) {
              const auto held = table.find({of, row});
              ASSERT_EQ(ring.value(of, row),
                        held == table.end() ? ring.not_computed : held->second);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace seqloop
