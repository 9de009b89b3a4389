// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

#include "program/drives/drives.hpp"
#include "program/options/model_options.hpp"

namespace seqloop::program {
namespace {

/// FNV-1a of a file's bytes.
std::uint64_t hash_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::uint64_t hash = 0xcbf29ce484222325U;
  std::array<char, 65536> some;
  while (in.read(some.data(), some.size()) || in.gcount() > 0) {
    for (const char c : std::span(some).first(static_cast<std::size_t>(in.gcount()))) {
      constexpr std::uint64_t prime = 0x100000001b3U;
      hash = (hash ^ static_cast<unsigned char>(c)) * prime;
    }
  }
  return hash;
}

}  // namespace

std::string fingerprint(const DriveSettings& settings) {
  std::string text = settings.descriptor.empty() ? "gradients" : settings.descriptor;
  if (text == "gradients") text += " of 256x128";  // without a size they are of 128x64
  opencv::ModelSettings model = settings.model;
  if (!model.model.empty()) {
    text = "model";
    for (const std::filesystem::path& file : model_files(model, settings.model_flags_given)) {
      text += fmt::format(" {:016x}", hash_of(file));
    }
    model = with_settings_beside(model, settings.model_flags_given);
  }
  if (!model.layer.empty()) text += " layer " + model.layer;
  if (model.input_width > 0) text += fmt::format(" {}x{}", model.input_width, model.input_height);
  if (!settings.model.model.empty()) {
    text += fmt::format(" mean {} scale {}{}", fmt::join(model.mean, ","), model.scale,
                        model.swap_rb ? " rgb" : "");
  }
  if (settings.words) text += fmt::format(" {} words", *settings.words);
  if (settings.remove_components.value_or(0) > 0) {
    text += fmt::format(" less {} components", *settings.remove_components);
  }
  for (const std::filesystem::path& drive : settings.training) {
    text += " trained on " + drive.string();
  }
  return text;
}

}  // namespace seqloop::program
