// SPDX-License-Identifier: MIT
#include "program/options/model_options.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <utility>

#include "program/options/config_file.hpp"
#include "program/options/verb.hpp"

namespace seqloop::program {
namespace {

void set_input_size(opencv::ModelSettings& model, std::string_view text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos) {
    throw std::invalid_argument("'" + std::string(text) + "' is not WIDTHxHEIGHT");
  }
  constexpr std::size_t most = 8192;
  const std::size_t width = parse_count(text.substr(0, cross));
  const std::size_t height = parse_count(text.substr(cross + 1));
  if (width == 0 || height == 0 || width > most || height > most) {
    throw std::invalid_argument("'" + std::string(text) + "' is not between 1x1 and 8192x8192");
  }
  model.input_width = static_cast<int>(width);
  model.input_height = static_cast<int>(height);
}

void set_mean(opencv::ModelSettings& model, std::string_view text) {
  const std::vector<double> mean = parse_numbers(text, ',');
  if (mean.size() != model.mean.size()) {
    throw std::invalid_argument("'" + std::string(text) + "' is not three numbers B,G,R");
  }
  std::ranges::transform(mean, model.mean.begin(),
                         [](double value) { return static_cast<float>(value); });
}

/// Empty where there is none.
std::filesystem::path settings_beside(const std::filesystem::path& model) {
  std::filesystem::path beside = model;
  beside.replace_extension(".toml");
  if (std::filesystem::exists(beside)) return beside;
  beside = model;
  beside += ".toml";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

}  // namespace

OptionTable model_options(opencv::ModelSettings& model) {
  OptionTable options;
  options.path("config-model", Access::reads, model.config_model,
               "second model file where the format has one, such as Caffe's prototxt");
  options.text("layer", model.layer, "layer by its name in the model file [the last one]");
  options.add({"input-size", ValueKind::size, "WxH in pixels [as the model says]",
               [&model](std::string_view value) { set_input_size(model, value); }});
  options.add({"mean", ValueKind::triple, "B,G,R to subtract [0,0,0]",
               [&model](std::string_view value) { set_mean(model, value); }});
  options.number("scale", model.scale, "factor after the mean is subtracted [1]");
  options.flag("swap-rb", model.swap_rb, "the model wants red first");
  return options;
}

opencv::ModelSettings with_settings_beside(opencv::ModelSettings model,
                                           const std::vector<std::string>& given) {
  const std::filesystem::path beside = settings_beside(model.model);
  if (beside.empty()) return model;
  const OptionTable options = model_options(model);
  std::vector<std::string> known;
  for (const Option& option : options.options()) known.push_back(option.name);
  const std::set<std::string> set_already(given.begin(), given.end());
  refuse(apply_config_file(beside, options, set_already, known));
  if (!set_already.contains("config-model") && model.config_model.is_relative() &&
      !model.config_model.empty()) {
    model.config_model = beside.parent_path() / model.config_model;
  }
  return model;
}

std::vector<std::filesystem::path> model_files(const opencv::ModelSettings& model,
                                               const std::vector<std::string>& given) {
  std::vector<std::filesystem::path> files{model.model, settings_beside(model.model),
                                           with_settings_beside(model, given).config_model};
  std::erase(files, std::filesystem::path());
  return files;
}

}  // namespace seqloop::program
