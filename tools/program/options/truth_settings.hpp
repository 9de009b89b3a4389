// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "evaluation/measures.hpp"
#include "evaluation/truth.hpp"
#include "program/options/options.hpp"

namespace seqloop::program {

/// Where the truth about a drive comes from.
struct TruthSettings {
  /// Or `identity`, or `no-revisit`; empty: positions where given, else identity.
  std::filesystem::path file;
  std::optional<std::size_t> tolerance;       ///< frames; not with positions
  std::filesystem::path reference_positions;  ///< empty beside the query's: loops within it
  std::filesystem::path query_positions;
  std::optional<double> radius_m;
  std::optional<evaluation::Unlisted> unlisted;  ///< wrong, when nobody says
};

/// @param settings lives as long as the table
void add_truth_options(OptionTable& options, TruthSettings& settings);

/// Frames by which a match may be off.
[[nodiscard]] std::size_t tolerance(const TruthSettings& settings);

/// Whether frame i of the query shows place i.
[[nodiscard]] bool by_identity(const TruthSettings& settings);

/// Whether there is a file that the truth is read from, at `file`.
[[nodiscard]] bool by_file(const TruthSettings& settings);

/// The truth, unless it is identity, for which somebody has to say how long it is. Adds faults.
[[nodiscard]] evaluation::Truth read_truth(const TruthSettings& settings, Faults& faults);

/// A truth, and how many queries have one.
struct JudgedBy {
  evaluation::Truth truth;
  std::uint64_t frames = 0;
};

/// Says how long identity is: as many frames as there are, or as the answers reach.
/// @param truth  what `read_truth` made of the settings, unless it is identity
/// @param frames queries that have a truth; 0: as many as the truth says
/// Adds a fault where these are fewer than have a truth.
[[nodiscard]] JudgedBy judge_by(const TruthSettings& settings, evaluation::Truth truth,
                                std::uint64_t frames, std::span<const evaluation::Answer> answers,
                                Faults& faults);

/// What `--threshold-on` says. Throws std::invalid_argument: why not.
[[nodiscard]] evaluation::ThresholdOn parse_threshold(std::string_view text);

/// How far off an answer may be that is right by this truth, in words.
[[nodiscard]] std::string how_near(const TruthSettings& settings, const evaluation::Truth& truth);

}  // namespace seqloop::program
