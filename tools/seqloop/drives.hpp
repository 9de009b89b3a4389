#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "files/npy_file.hpp"
#include "opencv/dnn_describer.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/options.hpp"

namespace seqloop::program {

/// A drive to open, and what to describe its pictures with.
struct DriveSettings {
  opencv::ModelSettings model;  ///< empty path: the built-in descriptor
  std::vector<std::string> model_flags_given;
  double fps = 10.0;
  Difference difference = Difference::euclidean;  ///< how described drives will be compared
};

/// Model and picture flags. @param settings lives as long as the table
void add_drive_options(OptionTable& options, DriveSettings& settings);

/// Opens the model, with what the TOML file beside it says unless a flag says otherwise.
/// Throws SetupError.
[[nodiscard]] std::unique_ptr<Describer> open_describer(const DriveSettings& settings);

/// Opens an image folder, a video or an `.npy` file. Throws SetupError.
/// @param flag the flag that names the drive, for the message when it was not given
[[nodiscard]] std::unique_ptr<FrameSource> open_drive(const std::filesystem::path& path,
                                                      const std::string& flag,
                                                      const DriveSettings& settings);

/// Reads an `.npy` file, and brings its rows to unit length where Euclid wants that (Algorithm 1);
/// says so where one was not. Throws SetupError.
[[nodiscard]] files::Matrix read_descriptors(const std::filesystem::path& path,
                                             Difference difference);

/// Whether a drive was described before, so that no describer is needed.
[[nodiscard]] bool is_described(const std::filesystem::path& path);

/// Tells the user, on stderr, what the source has to say of itself.
void tell_notes(const std::filesystem::path& path, const FrameSource& source);

}  // namespace seqloop::program
