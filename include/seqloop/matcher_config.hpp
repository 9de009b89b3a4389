// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "seqloop/fault.hpp"

namespace seqloop {

/// How two descriptors are compared.
enum class Difference : std::uint8_t {
  euclidean,     ///< between unit vectors (Algorithm 2)
  mean_absolute  ///< between patch-normalised pictures (SeqSLAM)
};

/// In what form places are kept and compared.
enum class Arithmetic : std::uint8_t {
  float32,  ///< as they come, 4 bytes a value: to the paper's letter
  int8,     ///< one byte a value; whole numbers from there on, so that answers are the same on
            ///< every processor
  sketch    ///< 2,048 bits a place, whatever the size of the descriptor
};

/// Which rows of the map a frame is compared with (src/README.md, section 3.6).
enum class Candidates : std::uint8_t {
  all,      ///< SeqCNNSLAM: every row
  ranges,   ///< A-SeqCNNSLAM, Algorithm 4: K ranges around the last frame's best rows
  adaptive  ///< O-SeqCNNSLAM, Algorithm 5: the same, K adapted online
};

/// Whether the drive becomes part of the map. Either way the map may hold sessions of earlier
/// drives, all of whose places are candidates.
enum class Use : std::uint8_t {
  localise,    ///< the map does not change, and holds earlier sessions
  close_loops  ///< the drive is added as a session; its newest `exclude` frames are no candidates
};

/// What decides whether a frame's best row is a place that the robot has been to.
enum class Decision : std::uint8_t {
  probability,  ///< evidence over time, calibrated
  uniqueness    ///< the paper's: how far the best row of one window stands out
};

/// What becomes of a frame when the map, closing loops, is full.
enum class FullMap : std::uint8_t {
  refuse,         ///< it becomes no place
  forget_oldest,  ///< it takes the oldest place's room
  thin            ///< it takes the room of the place that differs least from those around it
};

/// How A- and O-SeqCNNSLAM find places that are outside their ranges, in place of the paper's full
/// search.
struct Relocalising {
  bool operator==(const Relocalising&) const = default;

  /// Off: full searches, as published. On: no frame costs more than any other.
  bool on = true;
  /// Rows of the map that a frame scans by their sketches; the next frame goes on where it ended;
  /// >= 2; by probability >= 20, from which the scene is known.
  std::size_t rows_scanned = 4096;
  /// The most descriptor distances that the candidates of a frame may cost; 0: `distances_a_frame`
  /// chooses; otherwise at least what keeping up with one range takes.
  std::size_t distances = 0;
};

/// How the features of a descriptor are weighed before they are compared.
struct Standardisation {
  bool operator==(const Standardisation&) const = default;

  /// Divide each feature by its deviation around its running mean. Off: descriptors as they come.
  bool on = true;
  /// The weight, in frames, of what a drive starts from, one that becomes the map as well: the
  /// map's statistics or, where it has none, the first frame's; >= 1. Where a drive is localised
  /// (`Use::localise`), the map's have a third of it.
  std::size_t prior_frames = 15;
  /// A frame never weighs less than 1/horizon, so that the statistics follow light and
  /// surroundings; >= 1, frames.
  std::size_t horizon = 30;

  /// What the map's statistics weigh for a drive that is localised: it may begin anywhere on the
  /// map, and has to be standardised soon as the places there were.
  [[nodiscard]] std::size_t prior_where_localised() const noexcept {
    constexpr std::size_t part = 3;
    return prior_frames < part ? 1 : prior_frames / part;
  }
};

/// Everything a detector can be told, with the paper's values (Table 2) where it has any. Counts
/// without another upper bound go to 1,000,000,000.
struct MatcherConfig {
  Candidates candidates = Candidates::adaptive;
  Difference difference = Difference::euclidean;
  /// What is not float32 wants Euclidean differences.
  Arithmetic arithmetic = Arithmetic::int8;
  Use use = Use::localise;
  std::size_t sequence_length =
      20;             ///< ds: a window holds ds + 1 columns; 0 .. 2,000 frames, 0: single frames
  double vmin = 0.8;  ///< slowest trajectory, rows a frame; 0 .. vmax
  double vmax = 1.2;  ///< fastest trajectory, rows a frame; vmin .. 10
  std::size_t rwindow = 10;  ///< rows around the best that cannot be the runner-up; >= 0
  /// SeqSLAM's local contrast enhancement: each difference becomes its deviation from those of the
  /// rwindow rows around it. Needs rwindow >= 2; closing loops, exclude above rwindow / 2.
  bool enhance = false;
  std::size_t k = 10;          ///< A-: number of ranges; 1 .. 1,000
  std::size_t initial_k = 30;  ///< O-: K0, where K starts and falls back to; 1 .. 1,000
  std::size_t num = 16;        ///< a range holds num + 1 rows; >= 1
  /// L: every L-th matched frame searches all rows, where relocalising is off; >= 1
  std::size_t reinit = 450;
  Relocalising relocalising{};  ///< A- and O-: how places outside the ranges are found
  /// Closing loops, those of a drive to be localised in too: newest frames that are no places; >=
  /// 1, closing loops 1 .. 1,000,000
  std::size_t exclude = 20;
  FullMap full_map = FullMap::refuse;  ///< closing loops: what a full map does
  Standardisation standardisation{};
  /// Frames that `Detector::steps` takes, reading the places once; 1 .. most_frames_at_once. Each
  /// beyond the first keeps a column of differences and a descriptor more.
  std::size_t frames_at_once = 1;
  static constexpr std::size_t most_frames_at_once = 64;
  /// A blank descriptor (`blank()`: a covered lens, a black tunnel) counts as a frame that could
  /// not be read. Otherwise all such frames look alike, and match each other with top certainty.
  bool blank_is_unreadable = true;
  /// Make sequences of keyframes where it relocalises, standardises and decides by probability
  /// (src/README.md, section 5.11). Off: of all frames.
  bool keyframes = true;
  Decision decision = Decision::probability;
  float min_probability = 0.99F;  ///< a match must be at least this probable; above 0 .. 1
  /// Frames that come after a frame before its answer is due at the latest; 0 .. 1,000. Each keeps
  /// a descriptor and what is believed.
  std::size_t patience = 120;
  /// By uniqueness: a match must be at least this unique; above 0 .. 1
  float max_uniqueness = 0.94F;

  bool operator==(const MatcherConfig&) const = default;
};

/// What a detector and its map must have room for.
struct Capacity {
  std::size_t places = 0;  ///< rows of the map; 1 .. 2^32 - 1
  /// Values in a descriptor, D; 1 .. 2^22, to 2^17 where they are not kept as float32, or `scans`.
  std::size_t descriptor_size = 0;
  /// Of the map, the running one too; 1 .. 2^32 - 1. One whose places have all gone counts as well.
  std::size_t sessions = 1;
};

/// Whether a frame has candidate ranges and a part of the map to scan, and never all rows.
[[nodiscard]] bool relocalises(const MatcherConfig& config) noexcept;

/// Whether places have sketches by which each frame looks at part of the map: to relocalise, or
/// to decide by probability.
[[nodiscard]] bool scans(const MatcherConfig& config) noexcept;

/// Whether sequences are made of keyframes, in place of all frames.
[[nodiscard]] bool has_keyframes(const MatcherConfig& config) noexcept;

/// Whether frames are moved to the side where the robot drives beside its old track, if the map
/// knows how descriptors are laid out (`PlaceMap::set_columns`; src/README.md, section 5.13).
[[nodiscard]] bool moves_frames(const MatcherConfig& config) noexcept;

/// The most descriptor distances that the candidates of one frame may cost where the detector
/// relocalises: seven times what keeping up with one range takes, or 256 if that is more, unless
/// the configuration says.
[[nodiscard]] std::size_t distances_a_frame(const MatcherConfig& config) noexcept;

/// The fewest places with which a map that forgets or thins out has candidates once it is full:
/// those that are too new, and a line's rows.
[[nodiscard]] std::size_t least_places(const MatcherConfig& config) noexcept;

/// @return everything that is wrong with the configuration, with the member's name first.
[[nodiscard]] Faults validate(const MatcherConfig& config);
/// @return everything that is wrong with the capacity for this configuration.
[[nodiscard]] Faults validate(const Capacity& capacity, const MatcherConfig& config);

/// Errors: SetupError with everything that is wrong with either.
void check(const MatcherConfig& config, const Capacity& capacity);

}  // namespace seqloop
