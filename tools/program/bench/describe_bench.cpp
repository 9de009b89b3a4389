// SPDX-License-Identifier: MIT
#include "program/bench/describe_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "program/bench/step_bench.hpp"
#include "seqloop/frame.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "synthetic/driven_detector.hpp"

namespace seqloop::program {
namespace {

constexpr int width = 640;
constexpr int height = 480;

/// A picture with edges in all directions. What is in it does not change what it costs.
std::vector<std::uint8_t> synthetic_picture() {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double wave = std::sin(0.05 * x + 0.0004 * x * y) + std::sin(0.07 * y);
      for (int channel = 0; channel < 3; ++channel) {
        pixels.push_back(static_cast<std::uint8_t>(128.0 + 50.0 * wave + 5.0 * channel));
      }
    }
  }
  return pixels;
}

Image image_of(const std::vector<std::uint8_t>& pixels) {
  return {pixels.data(), width, height, std::size_t{width} * 3, PixelFormat::bgr8};
}

/// Of what is asked for beside the built-in descriptor; empty when nothing is.
std::string name_of(const DriveSettings& drive) {
  const opencv::ModelSettings& model = drive.model;
  std::string name = model.model.empty() ? drive.descriptor
                                         : model.model.stem().string() +
                                               (model.layer.empty() ? "" : ":" + model.layer);
  if (drive.remove_components) {
    if (name.empty()) name = "gradients";
    name += fmt::format(" less {} components", *drive.remove_components);
  }
  return name;
}

void describe(Describer& describer, const Image& image, std::span<float> descriptor) {
  if (describer.describe(image, descriptor) != Description::failed) return;
  throw std::runtime_error("describe: " + std::string(describer.last_fault()));
}

}  // namespace

void time_describing(const DriveSettings& drive, std::size_t rounds,
                     std::vector<Contender>& timed) {
  const std::vector<std::uint8_t> pixels = synthetic_picture();
  std::vector<std::pair<std::string, std::unique_ptr<Describer>>> describers;
  describers.emplace_back("seqloop-built-in", opencv::make_builtin_describer());
  const std::string other = name_of(drive);
  if (!other.empty()) describers.emplace_back(other, open_describer(drive));
  std::vector<Contender> contenders;
  std::vector<std::vector<float>> outputs;
  outputs.reserve(describers.size());
  for (const auto& [name, describer] : describers) {
    std::vector<float>& output = outputs.emplace_back(describer->size());
    contenders.push_back(
        {"describe", name, 0, describer->size(), pixels.size(),
         [&, worker = describer.get()] { describe(*worker, image_of(pixels), output); }});
  }
  time_in_turn(std::move(contenders), rounds, timed);
}

void time_loop(std::size_t places, std::size_t ds, double relocalise_s, std::size_t rounds,
               std::vector<Contender>& timed) {
  const std::vector<std::uint8_t> camera = synthetic_picture();
  std::vector<std::uint8_t> grabbed(camera.size());
  const auto describer = opencv::make_builtin_describer();
  std::vector<float> described(describer->size());
  for (const TimedMethod& method : timed_methods(ds, relocalise_s, places)) {
    if (method.config.arithmetic != Arithmetic::int8) continue;
    const auto drive =
        std::make_shared<DrivenDetector>(method.config, Capacity{places, describer->size()});
    const auto turn = [&, drive] {
      std::ranges::copy(camera, grabbed.begin());
      describe(*describer, image_of(grabbed), described);
      drive->step();
    };
    time_in_turn({{"loop", method.by, places, describer->size(), camera.size(), turn,
                   [drive] { drive->drive(); }}},
                 rounds, timed);
  }
}

}  // namespace seqloop::program
