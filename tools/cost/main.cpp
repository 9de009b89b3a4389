// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cost/instruction_counter.hpp"
#include "cost/serving_cost.hpp"
#include "cost/synthetic_picture.hpp"
#include "program/options/picture_margin.hpp"
#include "seqloop/fault.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/opencv/threads.hpp"
#include "seqloop/turbojpeg/mjpg_decoder.hpp"
#include "synthetic/driven_detector.hpp"

namespace seqloop::cost {
namespace {

constexpr std::size_t pictures = 5;
// More than once round a map of 100,000 places, scan by scan.
constexpr std::size_t steps = 60;

struct Cost {
  std::uint64_t mean = 0;
  std::uint64_t most = 0;
};

/// @param prepare, stage called in turn; what the stage executes is counted
template <typename Prepare, typename Stage>
Cost cost_of(const InstructionCounter& counter, std::size_t frames, Prepare&& prepare,
             Stage&& stage) {
  Cost cost;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    prepare();
    const std::uint64_t instructions = counter.count(stage);
    cost.mean += instructions;
    cost.most = std::max(cost.most, instructions);
  }
  cost.mean = (cost.mean + frames / 2) / frames;
  return cost;
}

void print(std::string_view stage, std::string_view descriptor, std::size_t places, Cost cost) {
  std::printf("%.*s,%.*s,%zu,%llu,%llu\n", static_cast<int>(stage.size()), stage.data(),
              static_cast<int>(descriptor.size()), descriptor.data(), places,
              static_cast<unsigned long long>(cost.mean),
              static_cast<unsigned long long>(cost.most));
  std::fflush(stdout);
}

void count_pictures(const InstructionCounter& counter, std::string_view name,
                    Describer& describer) {
  const std::vector<std::uint8_t> jpeg = synthetic_jpeg();
  const RawPicture raw{jpeg, synthetic_width, synthetic_height, 0, RawFormat::mjpg};
  turbojpeg::MjpgDecoder decoder(program::with_margin(describer.needs()));
  Image picture;
  std::vector<float> descriptor(describer.size());
  const auto grab = [&] {
    const std::string_view fault = decoder.decode(raw, picture);
    if (!fault.empty()) throw std::runtime_error(std::string(fault));
  };
  const auto describe = [&] {
    if (describer.describe(picture, descriptor) != Description::good) {
      throw std::runtime_error("the picture cannot be described");
    }
  };
  // What comes first takes memory and looks functions up.
  grab();
  describe();
  print("grab", name, 0,
        cost_of(
            counter, pictures, [] {}, grab));
  print("describe", name, 0,
        cost_of(
            counter, pictures, [] {}, describe));
}

void count_matching(const InstructionCounter& counter, std::string_view name, std::size_t places,
                    std::size_t descriptor_size) {
  MatcherConfig config;
  config.keyframes = false;  // each frame does all the work
  program::DrivenDetector drive(config, {places, descriptor_size});
  print("match", name, places,
        cost_of(
            counter, steps, [&] { drive.drive(); }, [&] { drive.step(); }));
}

std::size_t parse(std::string_view name, std::string_view text, std::size_t least) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < least) {
    throw SetupError(Fault{std::string(name), "'" + std::string(text) + "' is no number from " +
                                                  std::to_string(least) + " on"});
  }
  return number;
}

void count_clients(const std::vector<std::size_t>& all) {
  for (const std::size_t clients : all) {
    const ServingCost cost = count_serving(clients);
    const std::string name = std::to_string(clients) + "-clients";
    for (const auto& [stage, cost_of_one] : {std::pair{"publish", cost.publish},
                                             {"serve", cost.serve},
                                             {"serve-kernel", cost.with_kernel},
                                             {"bytes", cost.bytes}}) {
      // Which second costs most depends on when pages ask, and says nothing.
      print(stage, name, 0, {cost_of_one, cost_of_one});
    }
  }
}

constexpr std::string_view usage =
    "usage: seqloop-cost built-in|SQUEEZENET.onnx PLACES...\n"
    "       seqloop-cost serve CLIENTS...\n"
    "Counts the instructions of each stage of a frame on this thread: one synthetic 640x480 JPEG\n"
    "picture, and a drive through a map of synthetic places. Prints\n"
    "stage,descriptor,places,instructions_per_frame,most_instructions.\n"
    "serve: of a run at 30 frames a second that a number of pages look at. publish is the loop's "
    "thread,\n"
    "serve all others, serve-kernel these with what the kernel does for them, bytes what the "
    "pages\n"
    "receive; the mean of a frame.\n";

std::unique_ptr<Describer> open(std::string_view model) {
  if (model == "built-in") return opencv::make_builtin_describer();
  opencv::ModelSettings settings;
  settings.model = model;
  settings.layer = "pool5";
  settings.input_width = 224;
  settings.input_height = 224;
  settings.mean = {104.05F, 112.51F, 116.67F};
  settings.scale = 0.0039216F;
  return std::make_unique<opencv::DnnDescriber>(settings);
}

void count(std::string_view model, const std::vector<std::size_t>& all_places) {
  opencv::use_threads(1);
  const InstructionCounter counter;
  const std::unique_ptr<Describer> describer = open(model);
  const std::string_view name = model == "built-in" ? model : "pool5";
  count_pictures(counter, name, *describer);
  for (const std::size_t places : all_places) {
    count_matching(counter, name, places, describer->size());
  }
}

}  // namespace
}  // namespace seqloop::cost

int main(int argc, char** argv) {
  const bool asks_for_help = argc == 2 && std::string_view(argv[1]) == "--help";
  if (argc < 2 || asks_for_help) {
    std::fputs(seqloop::cost::usage.data(), asks_for_help ? stdout : stderr);
    return asks_for_help ? 0 : 2;
  }
  try {
    const bool serves = std::string_view(argv[1]) == "serve";
    std::vector<std::size_t> numbers;
    for (int i = 2; i < argc; ++i) {
      numbers.push_back(serves ? seqloop::cost::parse("clients", argv[i], 0)
                               : seqloop::cost::parse("places", argv[i], 4));
    }
    if (serves) {
      seqloop::cost::count_clients(numbers);
    } else {
      seqloop::cost::count(argv[1], numbers);
    }
  } catch (const seqloop::SetupError& error) {
    std::fprintf(stderr, "seqloop-cost: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "seqloop-cost: %s\n", error.what());
    return 1;
  }
  return 0;
}
