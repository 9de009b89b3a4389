// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/watch/watch.hpp"

namespace seqloop::program {

/// Small pictures of a drive, in bounded memory: of ever fewer frames as the drive grows, evenly.
class PictureStore {
 public:
  static constexpr std::size_t most_bytes = std::size_t{48} * 1024 * 1024;

  explicit PictureStore(std::size_t bytes = most_bytes) : most_bytes_(bytes) {}

  void add(const SmallPicture& picture);

  /// Frames of which one is kept: 1, 2, 4, …
  [[nodiscard]] std::uint64_t every() const noexcept { return every_; }

  /// The kept frames nearest to this one: the one at most before it, itself or the nearest, the
  /// next. Fewer at the ends; none where nothing is kept.
  [[nodiscard]] std::vector<std::uint64_t> around(std::uint64_t number) const;

  /// The newest one, kept or not.
  [[nodiscard]] std::optional<std::uint64_t> newest() const;

  /// As a JPEG file; empty where this frame has none. Allocates: yes.
  [[nodiscard]] std::string jpeg(std::uint64_t number) const;

 private:
  struct Kept {
    SmallPictureFacts facts;
    std::vector<std::uint8_t> pixels;
  };
  static Kept kept(const SmallPicture& picture);

  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t every_ = 1;
  std::map<std::uint64_t, Kept> kept_;
  std::optional<std::pair<std::uint64_t, Kept>> newest_;
};

}  // namespace seqloop::program
