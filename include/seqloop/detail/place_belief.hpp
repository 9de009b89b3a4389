// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_proposals.hpp"
#include "seqloop/detail/query_history.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// What the newest frame's likeliest row is judged by: the inputs of its probability.
struct Evidence {
  double odds = 0.0;      ///< ln of the belief in the row's place by that in all else
  double past = 0.0;      ///< the best log-odds on the way here, fading
  double lead = 0.0;      ///< how far it has done better than the best wrong rows usually do
  double contrast = 0.0;  ///< how much better it looks than the rows and frames around it
  double age = 0.0;       ///< ln (1 + novel frames that have followed it)
  double margin = 0.0;    ///< ln of the best other place's score by this one's, mean of windows
};

/// The log-odds that the newest frame's row of such evidence is where the robot is.
[[nodiscard]] double log_odds_now(const Evidence& evidence) noexcept;

/// The same of a row on the way there, once frames after it have come: the mean of what is said of
/// it frame by frame.
[[nodiscard]] double log_odds(const Evidence& evidence) noexcept;

/// Where the robot may be, and whether the map knows the place at all: a discrete Bayes filter over
/// a few rows and "somewhere new", fed by the sketches of each frame. How well a row has done is
/// compared with how well the best wrong rows do in this drive, which is learnt as it goes; a robot
/// that stands gains nothing. Source: src/README.md, section 6; Xu, Fischer, Suenderhauf, Milford
/// 2021.
class PlaceBelief {
 public:
  /// Rows that are weighed at a frame.
  static constexpr std::size_t most = 64;

  /// Pairs of sketches that one frame compares.
  static constexpr std::size_t most_sketches = 4 * most + 2;

  /// Frames before the newest one that are looked back on.
  static constexpr std::size_t reach = 20;

  /// Allocates: from the arena only.
  PlaceBelief(Arena& arena, const MatcherConfig& config);

  /// What there is to see.
  struct View {
    const QueryHistory* queries;
    const PlaceMap* map;
    const CandidateProposals* seen;  ///< which have looked at this frame
    std::uint64_t newest;            ///< the frame
    std::uint64_t oldest;            ///< that belongs together with it
    std::size_t rows;                ///< of the map that may be searched
  };

  /// Takes the newest frame. @return pairs of sketches compared
  /// Work: `most_sketches`, and 2^11 exponentials at most. Allocates: never.
  std::size_t observe(const View& view) noexcept;

  /// Frames went by unseen, and the robot moved on by so many rows in each.
  void pass(const PlaceOrder& order, std::uint64_t frames, std::size_t rows) noexcept;

  /// A row went from the map: those behind it are counted one lower.
  void removed(std::size_t row) noexcept;

  /// Nothing is known of where the robot is; what was learnt of the drive stays.
  void restart() noexcept;

  /// A row of the newest frame and what speaks for it.
  struct Likeliest {
    std::size_t row;
    std::size_t index;  ///< for `trace`
    Evidence evidence;
  };
  [[nodiscard]] const std::optional<Likeliest>& likeliest() const noexcept { return likeliest_; }

  /// Remembers the log-odds of the likeliest row. @return the best on the way there, fading
  double remember(double odds) noexcept;

  /// That the robot is somewhere new, 0 .. 1.
  [[nodiscard]] double new_place() const noexcept { return new_place_; }

  /// A frame on the way to a row.
  struct Step {
    std::size_t row;
    double gain;  ///< ln of how much likelier the frame is there than somewhere new
  };
  /// The way that a row was come by, frame by frame back from the newest.
  /// @param out written, as many as there are at most. @return how many. Work: as many.
  std::size_t trace(std::size_t index, std::span<Step> out) const noexcept;

  /// What the best wrong rows gain at a frame; 0 or more.
  [[nodiscard]] double usual_gain() const noexcept;

 private:
  struct Hypothesis {
    std::size_t row = 0;
    double mass = 0.0;      // belief
    double gain = 0.0;      // decaying sum of what its frames said for it
    double past = -10.0;    // best log-odds on the way, fading
    double contrast = 0.0;  // decaying mean
    double age = 0.0;       // novel frames
    std::uint32_t parent = 0;
  };
  struct Traced {
    std::uint32_t row;
    std::uint32_t parent;
    float gain;
  };
  /// A running mean and variance.
  struct Level {
    double mean = 0.0;
    double variance = 1.0;

    void follow(double value, double share) noexcept {
      const double off = value - mean;
      mean += share * off;
      variance = (1.0 - share) * (variance + share * off * off);
    }
    [[nodiscard]] double lead(double value) const noexcept;
  };
  /// How unlike the scanned rows are, as shares of differing bits.
  struct Scene {
    double mean;
    double deviation;
    double bias;
    double novelty;  // of the frame, 0 .. 1
  };

  [[nodiscard]] std::optional<Scene> look_around(const View& view) noexcept;
  [[nodiscard]] double novelty(const View& view, double mean) noexcept;
  void move(const PlaceOrder& order, std::span<const double> kernel) noexcept;
  void give_birth(const View& view, double mass) noexcept;
  void weigh(const View& view, const Scene& scene) noexcept;
  void sharpen(const PlaceOrder& order, const Scene& scene, std::span<const double> gains) noexcept;
  void judge(const View& view, const Scene& scene) noexcept;
  void write_trace(std::span<const double> gains) noexcept;
  [[nodiscard]] double share(const View& view, std::uint64_t frame, std::size_t row) noexcept;

  std::size_t depth_;
  std::size_t sketches_ = 0;
  std::uint64_t seen_ = 0;  // frames traced since the last restart
  double new_place_ = 1.0;
  Level wrong_;                // what the best wrong row gains
  double wrong_weight_ = 0.0;  // novel frames that it was learnt from
  std::size_t count_ = 0;
  std::size_t moved_count_ = 0;
  std::optional<Likeliest> likeliest_;
  std::span<Hypothesis> rows_;          // [most] in order of row
  std::span<Hypothesis> moved_;         // [4 most]
  std::span<Traced> traces_;            // [depth, most], a ring
  std::span<std::uint32_t> histogram_;  // [bits + 1] of the scan
};

}  // namespace seqloop
