// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "seqloop/frame_report.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// Loops with other robots that follow from the robot's own: where it is back at a place of its
/// own, and has found before that this is a place of another, it is back at that one.
///
/// Two maps decide, the robot's own and that of others. In one map of all, an own place and another
/// robot's would be visits of one place once that is found, and what speaks for the one would for
/// the other; where several robots know a place and nobody has linked theirs yet, these contest
/// each other, while nothing contests the robot's own.
class ThroughOwn {
 public:
  /// What it takes. @param own room of the own map
  [[nodiscard]] static std::vector<BufferSize> plan(const Capacity& own);

  /// @param config of the own map's detector, as the other one's but for its use
  /// @param own lives longer
  ThroughOwn(const MatcherConfig& config, const PlaceMap& own);

  /// Takes answers as they become due; both detectors count the same frames.
  /// @param own answers with places of the own map   @param others with those of others
  /// @return with places of others, one a frame: those that are accepted at once, the rest when
  ///   both answers are there. Valid until the next call.
  /// Work: log N and 42 rows an answer. Allocates: never.
  [[nodiscard]] std::span<const Answer> take(std::span<const Answer> own,
                                             std::span<const Answer> others) noexcept;

  /// The drive is over. @return the last ones, likewise
  [[nodiscard]] std::span<const Answer> finish(std::span<const Answer> own,
                                               std::span<const Answer> others) noexcept;

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  /// What is known of a frame until both answers are there.
  struct Pending {
    std::uint64_t frame = none;
    std::optional<Answer> own;
    std::optional<Answer> others;
    bool told = false;
  };
  /// An own place that is another robot's.
  struct Known {
    std::uint64_t number = none;  // of the own place: its slot may get another
    std::uint64_t other = 0;      // number
    float probability = 0.0F;
  };

  Pending& pending(std::uint64_t frame) noexcept;
  void take_both(Pending& frame) noexcept;
  void tell(Pending& frame) noexcept;
  void learn(std::optional<std::size_t> row, const Answer& others) noexcept;
  [[nodiscard]] std::optional<Known> known(std::optional<std::size_t> row) const noexcept;
  [[nodiscard]] std::optional<std::size_t> row_of_frame(std::uint64_t frame) const noexcept;
  [[nodiscard]] std::optional<std::size_t> first_visit(std::size_t row) const noexcept;

  const PlaceMap* own_;
  bool decides_;                  // by probability
  bool grows_;                    // the drive's frames become places
  std::vector<Pending> pending_;  // a ring by frame
  std::vector<Known> known_;      // by slot of the own map
  std::vector<Answer> answers_;
};

}  // namespace seqloop::program
