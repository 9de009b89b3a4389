// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>
#include <vector>

#include "sqlite/schema.hpp"

namespace seqloop::sqlite {

/// A row as it was read.
struct ReadRow {
  BlockRow row;
  bool whole = false;  ///< whether it is what was saved, and fits the map
};

/// Told of a row, which is valid during the call. @return whether it wants more
using TakeRow = std::function<bool(const ReadRow&)>;
/// Tells of rows until there are no more, or none are wanted.
using GiveRows = std::function<void(const TakeRow&)>;

/// Reads rows in a thread of its own, a few megabytes ahead of who takes them: while the disk is
/// waited for and checksums are computed, what was read before is dealt with. Allocates: three
/// megabytes, or as many of the largest rows.
class RowsAhead {
 public:
  /// Begins to read. @param read called in the thread; may throw
  explicit RowsAhead(const GiveRows& read);
  RowsAhead(const RowsAhead&) = delete;
  RowsAhead& operator=(const RowsAhead&) = delete;
  RowsAhead(RowsAhead&&) = delete;
  RowsAhead& operator=(RowsAhead&&) = delete;
  ~RowsAhead();

  /// Hands over all rows, in order, in the thread that calls it. Throws what `read` or `take` do.
  void give(const TakeRow& take);

 private:
  /// Copies of rows, one behind the other.
  struct Batch {
    std::vector<ReadRow> rows;
    std::vector<std::byte> bytes;
  };

  bool keep(const ReadRow& read);
  bool hand_over();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::queue<Batch> read_;   // to be taken
  std::queue<Batch> spare_;  // taken: their memory is used again
  bool all_read_ = false;
  bool unwanted_ = false;
  std::exception_ptr failed_;
  Batch filling_;  // the reading thread's
  std::thread thread_;
};

}  // namespace seqloop::sqlite
