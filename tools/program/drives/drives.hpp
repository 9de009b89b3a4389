// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::program {

/// A drive to open, and what to describe its pictures with.
struct DriveSettings {
  std::string descriptor;       ///< gradients, patches or words; empty: the model, or gradients
  opencv::ModelSettings model;  ///< empty path: none; the input size goes for patches, too
  std::vector<std::string> model_flags_given;
  std::vector<std::filesystem::path> training;   ///< drives to learn from
  std::optional<std::size_t> words;              ///< of the vocabulary [500]
  std::optional<std::size_t> remove_components;  ///< Change Removal [0, off]
  double fps = 10.0;
  std::string topic;                              ///< of bags; empty: the only one with pictures
  Difference difference = Difference::euclidean;  ///< how described drives will be compared
};

/// Flags that say how pictures are read and described. @param settings lives as long as the table
void add_drive_options(OptionTable& options, DriveSettings& settings);

/// Takes patches where they are what the difference compares and nobody says otherwise. Adds a
/// fault for a descriptor that the difference cannot compare.
void suit_descriptor(DriveSettings& settings, Difference difference, Faults& faults);

/// Looks for what is wrong, without learning. Throws SetupError.
void check_describer(const DriveSettings& settings, bool training_given);

/// Makes what describes pictures: a model, with what the TOML file beside it says unless a flag
/// says otherwise, or a descriptor by its name; what learns learns here, from `settings.training`.
/// Throws SetupError.
[[nodiscard]] std::unique_ptr<Describer> open_describer(const DriveSettings& settings);

/// The same, where more has been looked at. Learning takes long: where there are drives to learn
/// from and faults already, nothing is learned. Adds its own faults. @return null: there are faults
[[nodiscard]] std::unique_ptr<Describer> open_describer(const DriveSettings& settings,
                                                        Faults& faults);

/// The same, learning from drives that are open, which are read to their ends.
/// @param training instead of `settings.training`; may be empty where nothing learns
[[nodiscard]] std::unique_ptr<Describer> open_describer(const DriveSettings& settings,
                                                        std::span<FrameSource* const> training);

/// What describes pictures, in words that are equal only where descriptors can be compared: a model
/// by its files' bytes, what was learnt by where it was learnt. Throws SetupError.
[[nodiscard]] std::string fingerprint(const DriveSettings& settings);

/// Opens an image folder, a video, a bag or an `.npy` file. Throws SetupError.
/// @param flag the flag that names the drive, for the message when it was not given
/// @param describer that is all who looks at the pictures: motion JPEG in an AVI file is then
///   decoded no further than it needs, as a camera's is; null: pictures are whole and in colour
[[nodiscard]] std::unique_ptr<FrameSource> open_drive(const std::filesystem::path& path,
                                                      const std::string& flag,
                                                      const DriveSettings& settings,
                                                      const Describer* describer = nullptr);

/// Reads an `.npy` file, and brings its rows to unit length where Euclid wants that (Algorithm 1);
/// says so where one was not. Throws SetupError.
[[nodiscard]] files::Matrix read_descriptors(const std::filesystem::path& path,
                                             Difference difference);

/// Adds a fault for what says how drives are read, where none of them is read so.
/// @param drives all that are given; those without a name and those that are not there are left out
void check_reading(const DriveSettings& settings, std::span<const std::filesystem::path> drives,
                   Faults& faults);

/// Adds a fault for each setting that says how pictures are described. @param why none are
void refuse_describing(const DriveSettings& settings, const std::string& why, Faults& faults);

/// Whether a drive was described before, so that no describer is needed.
[[nodiscard]] bool is_described(const std::filesystem::path& path);

/// When second 0 of a drive was, in nanoseconds since 1970: a bag says it; a camera's is now; that
/// of other recordings is not known, and 0. @param recording null: a camera
[[nodiscard]] std::int64_t start_ns(const FrameSource* recording) noexcept;

/// Tells the user, on stderr, what the source has to say of itself.
void tell_notes(const std::filesystem::path& path, const FrameSource& source);

/// Tells the user, on stderr, when frames are blank, and that a drive of nothing else has no match.
void tell_blank(const std::filesystem::path& path, std::uint64_t blank, std::uint64_t frames);

}  // namespace seqloop::program
