// SPDX-License-Identifier: MIT
#include "program/watch/picture_store.hpp"

#include <iterator>
#include <utility>

namespace seqloop::program {

PictureStore::Kept PictureStore::kept(const SmallPicture& picture) {
  const auto* const first = picture.pixels.data();
  return {picture, {first, first + picture.bytes()}};
}

void PictureStore::add(const SmallPicture& picture) {
  newest_.emplace(picture.number, kept(picture));
  if (picture.number % every_ != 0) return;
  const auto [at, is_new] = kept_.insert_or_assign(picture.number, newest_->second);
  if (is_new) bytes_ += at->second.pixels.size();
  while (bytes_ > most_bytes_ && kept_.size() > 1) {
    every_ *= 2;
    std::erase_if(kept_, [this](const auto& one) {
      if (one.first % every_ == 0) return false;
      bytes_ -= one.second.pixels.size();
      return true;
    });
  }
}

std::vector<std::uint64_t> PictureStore::around(std::uint64_t number) const {
  if (kept_.empty()) return {};
  auto at = kept_.lower_bound(number);
  if (at == kept_.end()) --at;
  if (at->first > number && at != kept_.begin()) {
    const auto before = std::prev(at);
    if (number - before->first <= at->first - number) at = before;
  }
  std::vector<std::uint64_t> numbers;
  if (at != kept_.begin()) numbers.push_back(std::prev(at)->first);
  numbers.push_back(at->first);
  if (std::next(at) != kept_.end()) numbers.push_back(std::next(at)->first);
  return numbers;
}

std::optional<std::uint64_t> PictureStore::newest() const {
  if (!newest_) return std::nullopt;
  return newest_->first;
}

std::string PictureStore::jpeg(std::uint64_t number) const {
  const auto found = kept_.find(number);
  const bool is_newest = newest_ && newest_->first == number;
  if (found == kept_.end() && !is_newest) return {};
  const Kept& picture = found != kept_.end() ? found->second : newest_->second;
  constexpr int quality = 80;
  return program::jpeg(picture.facts, picture.pixels, quality);
}

}  // namespace seqloop::program
