// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/opencv/dnn_describer.hpp"

namespace seqloop::program {

/// What the command line and a model's own settings file may say of a model.
/// @param model lives as long as the table
[[nodiscard]] OptionTable model_options(opencv::ModelSettings& model);

/// Adds what the TOML file beside a model (MODEL.toml beside MODEL.onnx, or MODEL.onnx.toml) says.
/// @param given flags that the command line has set already: they win
/// Throws SetupError with every fault of the file.
[[nodiscard]] opencv::ModelSettings with_settings_beside(opencv::ModelSettings model,
                                                         const std::vector<std::string>& given);

/// Every file that says what a model is: the model, its settings file, its second file.
/// Throws SetupError as above.
[[nodiscard]] std::vector<std::filesystem::path> model_files(const opencv::ModelSettings& model,
                                                             const std::vector<std::string>& given);

}  // namespace seqloop::program
