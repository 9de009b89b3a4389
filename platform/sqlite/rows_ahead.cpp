// SPDX-License-Identifier: MIT
#include "sqlite/rows_ahead.hpp"

#include <algorithm>
#include <deque>
#include <utility>

namespace seqloop::sqlite {
namespace {

constexpr std::size_t batches = 3;  // one is filled, one waits, one is dealt with
constexpr std::size_t batch_bytes = std::size_t{1} << 20U;

std::span<const std::byte> copied(std::span<const std::byte> from, std::vector<std::byte>& to) {
  const std::size_t begin = to.size();
  to.insert(to.end(), from.begin(), from.end());
  return std::span(to).subspan(begin);
}

}  // namespace

RowsAhead::RowsAhead(const GiveRows& read)
    : spare_(std::deque<Batch>(batches - 1)), thread_([this, read] {
        try {
          read([this](const ReadRow& row) { return keep(row); });
        } catch (...) {
          failed_ = std::current_exception();
        }
        hand_over();
        const std::scoped_lock lock(mutex_);
        all_read_ = true;
        changed_.notify_all();
      }) {}

RowsAhead::~RowsAhead() {
  {
    const std::scoped_lock lock(mutex_);
    unwanted_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

/// Copies a row to where the others are; what is there does not move.
bool RowsAhead::keep(const ReadRow& read) {
  const BlockRow& row = read.row;
  const std::size_t more = row.records.size() + row.places.size();
  if (filling_.bytes.capacity() - filling_.bytes.size() < more) {
    if (!filling_.rows.empty() && !hand_over()) return false;
    filling_.bytes.reserve(std::max(more, batch_bytes));
  }
  ReadRow kept = read;
  kept.row.records = copied(row.records, filling_.bytes);
  kept.row.places = copied(row.places, filling_.bytes);
  filling_.rows.push_back(kept);
  return true;
}

/// Gives away what is filled, and waits for room to fill. @return whether more is wanted
bool RowsAhead::hand_over() {
  std::unique_lock lock(mutex_);
  read_.push(std::exchange(filling_, {}));
  changed_.notify_all();
  changed_.wait(lock, [this] { return unwanted_ || !spare_.empty(); });
  if (unwanted_) return false;
  filling_ = std::move(spare_.front());
  spare_.pop();
  filling_.rows.clear();
  filling_.bytes.clear();
  return true;
}

void RowsAhead::give(const TakeRow& take) {
  for (;;) {
    Batch batch;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return all_read_ || !read_.empty(); });
      if (read_.empty()) break;
      batch = std::move(read_.front());
      read_.pop();
    }
    for (const ReadRow& row : batch.rows) {
      if (!take(row)) return;
    }
    const std::scoped_lock lock(mutex_);
    spare_.push(std::move(batch));
    changed_.notify_all();
  }
  if (failed_) std::rethrow_exception(failed_);
}

}  // namespace seqloop::sqlite
