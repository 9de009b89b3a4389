#include "seqloop/drives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "files/descriptor_source.hpp"
#include "opencv/builtin_describer.hpp"
#include "opencv/source.hpp"
#include "opencv/threads.hpp"
#include "seqloop/config_file.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/say.hpp"
#include "seqloop/verb.hpp"

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

/// What a model's own settings file may hold, too.
OptionTable model_options(opencv::ModelSettings& model) {
  OptionTable options;
  options.path("config-model", model.config_model,
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

/// MODEL.toml beside MODEL.onnx, or MODEL.onnx.toml.
std::filesystem::path settings_beside(const std::filesystem::path& model) {
  std::filesystem::path beside = model;
  beside.replace_extension(".toml");
  if (std::filesystem::exists(beside)) return beside;
  beside = model;
  beside += ".toml";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

/// Brings every row to unit length, as Algorithm 1 wants it, and says so where one was not.
void normalise_rows(files::Matrix& matrix, const std::filesystem::path& name) {
  std::size_t changed = 0;
  for (std::size_t row = 0; row < matrix.rows; ++row) {
    const auto values = std::span(matrix.values).subspan(row * matrix.columns, matrix.columns);
    const double squares = squared_norm(values);
    // What describe wrote is unit to rounding and must stay as it is, bit by bit.
    if (squares == 0.0 || std::abs(squares - 1.0) < 1e-5) continue;
    normalise(values);
    ++changed;
  }
  if (changed > 0) {
    say("{}: {} of {} rows were not unit length and have been made so", name.string(), changed,
        matrix.rows);
  }
}

}  // namespace

void add_drive_options(OptionTable& options, DriveSettings& settings) {
  options.path("model", settings.model.model,
               "model file (ONNX, Caffe, TensorFlow, ...) [the built-in descriptor]");
  const OptionTable model = model_options(settings.model);
  for (Option option : model.options()) {
    option.set = [&settings, name = option.name, set = option.set](std::string_view value) {
      set(value);
      settings.model_flags_given.push_back(name);
    };
    options.add(std::move(option));
  }
  options.add({"fps", ValueKind::number, "frames a second of an image folder [10]",
               [&settings](std::string_view value) {
                 settings.fps = parse_number(value);
                 if (!(settings.fps >= 1e-3 && settings.fps <= 1e6)) {
                   throw std::invalid_argument("it must be between 0.001 and 1000000");
                 }
               }});
}

std::unique_ptr<Describer> open_describer(const DriveSettings& settings) {
  if (settings.model.model.empty()) {
    if (settings.model_flags_given.empty()) {
      opencv::use_threads(1);
      return opencv::make_builtin_describer();
    }
    Faults faults;
    for (const std::string& name : settings.model_flags_given) {
      faults.push_back({name, "it describes a model, but no model is given", "--model FILE"});
    }
    throw SetupError(std::move(faults));
  }
  opencv::ModelSettings model = settings.model;
  const std::filesystem::path beside = settings_beside(model.model);
  if (!beside.empty()) {
    const OptionTable options = model_options(model);
    std::vector<std::string> known;
    for (const Option& option : options.options()) known.push_back(option.name);
    const std::set<std::string> given(settings.model_flags_given.begin(),
                                      settings.model_flags_given.end());
    refuse(apply_config_file(beside, options, given, known));
    if (!given.contains("config-model") && model.config_model.is_relative() &&
        !model.config_model.empty()) {
      model.config_model = beside.parent_path() / model.config_model;
    }
  }
  return std::make_unique<opencv::DnnDescriber>(model);
}

files::Matrix read_descriptors(const std::filesystem::path& path, Difference difference) {
  files::Matrix descriptors = files::read_npy(path);
  if (difference == Difference::euclidean) normalise_rows(descriptors, path);
  return descriptors;
}

bool is_described(const std::filesystem::path& path) { return path.extension() == ".npy"; }

std::unique_ptr<FrameSource> open_drive(const std::filesystem::path& path, const std::string& flag,
                                        const DriveSettings& settings) {
  if (path.empty()) {
    throw SetupError({flag, "not given", "an image folder, a video or an .npy file"});
  }
  if (is_described(path)) {
    return std::make_unique<files::DescriptorSource>(read_descriptors(path, settings.difference),
                                                     settings.fps);
  }
  return opencv::open_source(path, {.frames_per_second = settings.fps});
}

void tell_notes(const std::filesystem::path& path, const FrameSource& source) {
  for (const std::string& note : source.notes()) {
    say("{}: {}", path.string(), note);
  }
}

}  // namespace seqloop::program
