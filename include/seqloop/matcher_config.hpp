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

/// Which rows of the map a frame is compared with (ALGORITHMS: the methods).
enum class Candidates : std::uint8_t {
  all,      ///< SeqCNNSLAM: every row
  ranges,   ///< A-SeqCNNSLAM, Algorithm 4: K ranges around the last frame's best rows
  adaptive  ///< O-SeqCNNSLAM, Algorithm 5: the same, K adapted online
};

/// What the map is.
enum class Use : std::uint8_t {
  localise,    ///< an earlier drive that does not change
  close_loops  ///< the drive itself, without its last `exclude` frames
};

/// How the features of a descriptor are weighed before they are compared.
struct Standardisation {
  bool operator==(const Standardisation&) const = default;

  /// Divide each feature by its deviation around its running mean. Off: descriptors as they come.
  bool on = true;
  /// How many frames that count for which a drive starts from: the map's statistics, or, without a
  /// map, the first frame's; >= 1.
  std::size_t prior_frames = 20;
  /// A frame never weighs less than 1/horizon, so that the statistics follow the day; >= 1, frames.
  std::size_t horizon = 100;
};

/// Everything a detector can be told, with the paper's values (Table 2) where it has any.
struct MatcherConfig {
  Candidates candidates = Candidates::adaptive;
  Difference difference = Difference::euclidean;
  Use use = Use::localise;
  std::size_t sequence_length =
      20;             ///< ds: a window holds ds + 1 columns; 0 .. 2,000 frames, 0: single frames
  double vmin = 0.8;  ///< slowest trajectory, rows a frame; 0 .. vmax
  double vmax = 1.2;  ///< fastest trajectory, rows a frame; vmin .. 10
  std::size_t rwindow = 10;  ///< rows around the best that do not count as rivals; >= 0
  /// SeqSLAM's local contrast enhancement: each difference becomes its deviation from those of the
  /// rwindow rows around it. Needs rwindow >= 2; closing loops, exclude above rwindow / 2.
  bool enhance = false;
  std::size_t k = 10;          ///< A-: number of ranges; 1 .. 1,000
  std::size_t initial_k = 30;  ///< O-: K0, where K starts and falls back to; 1 .. 1,000
  std::size_t num = 16;        ///< a range holds num + 1 rows; >= 1
  std::size_t reinit = 450;    ///< L: every L-th matched frame searches all rows; >= 1
  std::size_t exclude = 100;   ///< closing loops: newest frames that are no places; >= 1
  Standardisation standardisation{};
  /// A blank descriptor (`blank()`: a covered lens, a black tunnel) counts as a frame that could
  /// not be read. Otherwise all such frames look alike, and match each other with top certainty.
  bool blank_is_unreadable = true;
  float max_uniqueness = 0.94F;  ///< a match must be at least this unique; above 0 .. 1

  bool operator==(const MatcherConfig&) const = default;
};

/// What a detector and its map must have room for.
struct Capacity {
  std::size_t places = 0;           ///< rows of the map; 1 .. 2^32
  std::size_t descriptor_size = 0;  ///< values in a descriptor, D; 1 .. 2^22
};

/// @return everything that is wrong with the configuration, with the flag's name first.
[[nodiscard]] Faults validate(const MatcherConfig& config);
[[nodiscard]] Faults validate(const Capacity& capacity);

}  // namespace seqloop
