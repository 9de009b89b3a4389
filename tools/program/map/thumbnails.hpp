// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "program/drives/small_picture.hpp"
#include "seqloop/linux/detail/return_queue.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// Makes thumbnails of places, in a thread of its own: neither a frame nor the disk is in its way.
/// What finds no room is left out and counted, so that memory is bounded however long the disk
/// takes.
class Thumbnails {
 public:
  /// JPEG files that wait to be saved: half an hour of driving at 25 frames a second.
  static constexpr std::size_t most_bytes = std::size_t{48} * 1024 * 1024;

  explicit Thumbnails(JpegEncoder encode, std::size_t bytes = most_bytes);
  Thumbnails(const Thumbnails&) = delete;
  Thumbnails& operator=(const Thumbnails&) = delete;
  Thumbnails(Thumbnails&&) = delete;
  Thumbnails& operator=(Thumbnails&&) = delete;
  ~Thumbnails();

  /// The loop's side. @param place numbers ascend
  /// Work: the small picture's pixels. Allocates: never. No system call, no waiting.
  void add(const Image& image, std::uint64_t place) noexcept;

  /// No more come: waits until all are made.
  void finish();

  // The saving thread's side.

  /// Copies the oldest ones that wait, of places below this number. @param most how many at most
  [[nodiscard]] std::vector<sqlite::SavedThumbnail> waiting(std::uint64_t below,
                                                            std::size_t most) const;
  /// So many of these are saved.
  void saved(std::size_t count);

  /// Places that have none for lack of room.
  [[nodiscard]] std::uint64_t missing() const noexcept {
    return missing_.load(std::memory_order_relaxed);
  }

 private:
  // As many as come while the thread sleeps, and ten times more: 4 MB.
  using Pictures = live::ReturnQueue<PictureWithin<80, 60>, 256>;

  void work();
  void make();

  JpegEncoder encode_;
  std::size_t most_bytes_;
  Pictures pictures_;
  PictureWithin<80, 60> next_;  // the loop's
  std::atomic<std::uint64_t> missing_{0};

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;                         // under the mutex
  std::deque<sqlite::SavedThumbnail> files_;  // under the mutex
  std::size_t bytes_ = 0;                     // of these
  std::thread thread_;
};

}  // namespace seqloop::program
