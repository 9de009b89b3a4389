// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "program/fleet/place_number.hpp"
#include "program/fleet/same_places.hpp"
#include "seqloop/detector.hpp"

namespace seqloop::program {

/// Places of other robots, in which a drive is localised while they come. Each robot's session is
/// one of the map. Steps allocate nothing.
class OthersMap {
 public:
  /// How the drive is localised in it. @param config of the run's own detector
  [[nodiscard]] static MatcherConfig suited(MatcherConfig config);

  /// What it takes beside its map and its detector. @param capacity room for places, sessions
  [[nodiscard]] static std::vector<BufferSize> plan(const Capacity& capacity);

  /// A place of another robot.
  struct Place {
    std::uint32_t session = 0;  ///< as it was first heard
    std::uint64_t frame = 0;    ///< of the session
  };

  /// @param config of the run's own detector   @param places, sessions room for them
  /// @param own the run's map: frames are standardised as it says. Throws SetupError; bad_alloc.
  OthersMap(const MatcherConfig& config, std::size_t places, std::size_t sessions,
            const PlaceMap& own);
  OthersMap(const OthersMap&) = delete;
  OthersMap& operator=(const OthersMap&) = delete;
  OthersMap(OthersMap&&) = delete;
  OthersMap& operator=(OthersMap&&) = delete;
  ~OthersMap() = default;

  /// @param place behind the last of its session   @param bytes as saved
  /// @return false where it is none that can be, or there is no room. Work: 2 N bytes moved.
  [[nodiscard]] bool take_in(const Place& place, std::span<const std::byte> bytes) noexcept;

  /// Two places are one, as far as both are known.
  void same_place(const Place& one, const Place& other) noexcept;

  /// The drive's next frame, after some that never came.
  [[nodiscard]] FrameReport step(std::span<const float> descriptor, std::uint64_t lost) noexcept;

  /// The drive is over. @return the last answers
  [[nodiscard]] std::span<const Answer> finish() noexcept { return detector_.finish(); }

  /// @param number as answers have it
  [[nodiscard]] Place where(std::uint64_t number) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return map_.size(); }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  [[nodiscard]] std::uint64_t number(const Place& place) const noexcept {
    return place_number(begun_[place.session], place.frame);
  }

  PlaceMap map_;
  Detector detector_;
  SamePlaces same_;
  std::vector<std::uint32_t> begun_;     // by session as it was heard: which of the map, or `none`
  std::vector<std::uint32_t> heard_of_;  // by session of the map: as it was heard
  std::vector<SamePlaces::Told> told_;   // by session as it was heard
  std::uint32_t used_ = 0;
};

}  // namespace seqloop::program
