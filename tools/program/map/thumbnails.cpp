// SPDX-License-Identifier: MIT
#include "program/map/thumbnails.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <span>
#include <string>

namespace seqloop::program {
namespace {

// The loop cannot wake the thread without a system call, so the thread looks itself.
constexpr auto between_looks = std::chrono::milliseconds(20);

constexpr int quality = 60;  // of 100: who looks is to know the place, no more

}  // namespace

Thumbnails::Thumbnails(JpegEncoder encode, std::size_t bytes)
    : encode_(encode), most_bytes_(bytes) {
  thread_ = std::thread([this] { work(); });
}

Thumbnails::~Thumbnails() { finish(); }

void Thumbnails::add(const Image& image, std::uint64_t place) noexcept {
  if (!shrink(image, place, next_)) return;
  if (!pictures_.push(next_)) missing_.fetch_add(1, std::memory_order_relaxed);
}

void Thumbnails::finish() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
  make();
}

void Thumbnails::work() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, between_looks, [this] { return stop_; })) {
    lock.unlock();
    make();
    lock.lock();
  }
}

/// Makes files of all pictures that have come.
void Thumbnails::make() {
  for (; const auto* const picture = pictures_.front(); pictures_.pop()) {
    try {
      const std::string file = encode_(*picture, picture->pixels, quality);
      const auto bytes = std::as_bytes(std::span(file));
      const std::scoped_lock lock(mutex_);
      if (bytes_ + bytes.size() <= most_bytes_) {
        files_.push_back({picture->number, {bytes.begin(), bytes.end()}});
        bytes_ += bytes.size();
        continue;
      }
    } catch (const std::exception&) {  // a place without a picture is a place all the same
    }
    missing_.fetch_add(1, std::memory_order_relaxed);
  }
}

std::vector<sqlite::SavedThumbnail> Thumbnails::waiting(std::uint64_t below,
                                                        std::size_t most) const {
  const std::scoped_lock lock(mutex_);
  const auto end = std::ranges::lower_bound(files_, below, {}, &sqlite::SavedThumbnail::place);
  const auto count =
      std::min<std::ptrdiff_t>(end - files_.begin(), static_cast<std::ptrdiff_t>(most));
  return {files_.begin(), files_.begin() + count};
}

void Thumbnails::saved(std::size_t count) {
  const std::scoped_lock lock(mutex_);
  for (; count > 0; --count) {
    bytes_ -= files_.front().jpeg.size();
    files_.pop_front();
  }
}

}  // namespace seqloop::program
