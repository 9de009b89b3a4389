// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "program/drives/drives.hpp"
#include "program/options/model_options.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "program/process/say.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/opencv/bag_of_words.hpp"
#include "seqloop/opencv/builtin_describer.hpp"
#include "seqloop/opencv/change_removal.hpp"
#include "seqloop/opencv/patch_describer.hpp"
#include "seqloop/opencv/threads.hpp"

namespace seqloop::program {
namespace {

/// One of the descriptors, or "model".
std::string kind_of(const DriveSettings& settings) {
  if (!settings.model.model.empty()) return "model";
  return settings.descriptor.empty() ? "gradients" : settings.descriptor;
}

void check_name(const DriveSettings& settings, Faults& faults) {
  static const std::vector<std::string> descriptors{"gradients", "patches", "words"};
  const std::string& name = settings.descriptor;
  if (name.empty()) return;
  if (std::ranges::find(descriptors, name) == descriptors.end()) {
    const std::string meant = nearest(name, descriptors);
    faults.push_back(
        {"descriptor", "'" + name + "' is no known descriptor",
         meant.empty() ? "take gradients, patches or words" : "did you mean '" + meant + "'?"});
  }
  if (!settings.model.model.empty()) {
    faults.push_back({"descriptor", "a model is given, which describes", "leave out one of them"});
  }
}

bool removes(const DriveSettings& settings) { return settings.remove_components.value_or(0) > 0; }

/// Settings that do not go together.
void check(const DriveSettings& settings, bool training_given, Faults& faults) {
  check_name(settings, faults);
  const std::string kind = kind_of(settings);
  for (const std::string& name : settings.model_flags_given) {
    if (kind == "model" || (kind == "patches" && name == "input-size")) continue;
    faults.push_back(
        {name, "it describes a model, but no model is given",
         name == "input-size" ? "--model FILE or --descriptor patches" : "--model FILE"});
  }
  if (settings.words && kind != "words") {
    faults.push_back({"words", "there is no vocabulary", "--descriptor words"});
  } else if (settings.words == 0U) {
    faults.push_back({"words", "0 tell no picture from another", "ask for at least 1"});
  }
  if (removes(settings) && (kind == "patches" || kind == "words")) {
    faults.push_back({"remove-components", "works around a net, and " + kind + " have none",
                      "take gradients or a model"});
  }
  if ((removes(settings) || kind == "words") && !training_given) {
    faults.push_back({"training", "not given", "--training DRIVE, or several"});
  }
  if (!settings.training.empty() && kind != "words" && !settings.remove_components) {
    faults.push_back(
        {"training", "nothing is learned from it", "--descriptor words or --remove-components M"});
  }
}

/// None for what is no net, or needs none.
std::unique_ptr<opencv::DnnDescriber> open_net(const DriveSettings& settings) {
  const std::string kind = kind_of(settings);
  if (kind == "model") {
    return std::make_unique<opencv::DnnDescriber>(
        with_settings_beside(settings.model, settings.model_flags_given));
  }
  return kind == "gradients" && removes(settings) ? opencv::make_builtin_net() : nullptr;
}

std::unique_ptr<Describer> open_patches(const opencv::ModelSettings& model) {
  if (model.input_width == 0) return std::make_unique<opencv::PatchDescriber>();
  return std::make_unique<opencv::PatchDescriber>(model.input_width, model.input_height);
}

std::unique_ptr<Describer> learn_removal(std::unique_ptr<opencv::DnnDescriber> net,
                                         std::span<FrameSource* const> training,
                                         std::size_t components) {
  auto removal = std::make_unique<opencv::ChangeRemoval>(std::move(net), training, components,
                                                         stop_if_interrupted);
  if (removal->components() < components) {
    say("remove-components: the training pictures vary in {} only, not {}",
        counted(removal->components(), "direction"), components);
  }
  return removal;
}

/// Learns last, because that takes long. @param faults found before
std::unique_ptr<Describer> make(const DriveSettings& settings,
                                std::span<FrameSource* const> training, Faults faults) {
  constexpr std::size_t usual_words = 500;
  const std::string kind = kind_of(settings);
  if (kind == "gradients" || kind == "patches") opencv::use_threads(1);
  std::unique_ptr<opencv::DnnDescriber> net;
  std::unique_ptr<Describer> patches;
  collect(faults, [&] { net = open_net(settings); });
  if (kind == "patches") collect(faults, [&] { patches = open_patches(settings.model); });
  refuse(std::move(faults));

  if (patches) return patches;
  if (removes(settings))
    return learn_removal(std::move(net), training, *settings.remove_components);
  if (net) return net;
  if (kind == "gradients") return opencv::make_builtin_describer();
  return std::make_unique<opencv::BagOfWords>(training, settings.words.value_or(usual_words),
                                              stop_if_interrupted);
}

}  // namespace

void suit_descriptor(DriveSettings& settings, Difference difference, Faults& faults) {
  settings.difference = difference;
  const bool patches = difference == Difference::mean_absolute;
  if (patches && settings.descriptor.empty() && settings.model.model.empty()) {
    settings.descriptor = "patches";
  }
  if (patches != (kind_of(settings) == "patches")) {
    faults.push_back(
        {"descriptor",
         kind_of(settings) + " cannot be compared by " +
             (patches ? "mean absolute difference" : "Euclidean distance"),
         "patches go with --method seqslam or --difference mean-absolute, all others do not"});
  }
}

void refuse_describing(const DriveSettings& settings, const std::string& why, Faults& faults) {
  for (const std::string& flag : settings.model_flags_given)
    faults.push_back({flag, why, "leave it out"});
  refuse_given(faults,
               {{"descriptor", !settings.descriptor.empty()},
                {"model", !settings.model.model.empty()},
                {"training", !settings.training.empty()},
                {"words", settings.words.has_value()},
                {"remove-components", settings.remove_components.has_value()}},
               why);
}

void check_describer(const DriveSettings& settings, bool training_given) {
  Faults faults;
  check(settings, training_given, faults);
  collect(faults, [&] { static_cast<void>(open_net(settings)); });
  if (kind_of(settings) == "patches") {
    collect(faults, [&] { static_cast<void>(open_patches(settings.model)); });
  }
  refuse(std::move(faults));
}

std::unique_ptr<Describer> open_describer(const DriveSettings& settings,
                                          std::span<FrameSource* const> training) {
  Faults faults;
  check(settings, !training.empty(), faults);
  return make(settings, training, std::move(faults));
}

std::unique_ptr<Describer> open_describer(const DriveSettings& settings) {
  Faults faults;
  std::unique_ptr<Describer> describer = open_describer(settings, faults);
  refuse(std::move(faults));
  return describer;
}

std::unique_ptr<Describer> open_describer(const DriveSettings& settings, Faults& faults) {
  Faults own;
  check(settings, !settings.training.empty(), own);
  std::vector<std::unique_ptr<FrameSource>> drives;
  std::vector<FrameSource*> training;
  for (const std::filesystem::path& path : settings.training) {
    if (is_described(path)) {
      own.push_back({"training", path.string() + " holds descriptors already",
                     "give image folders or videos"});
      continue;
    }
    collect(own, [&] {
      training.push_back(drives.emplace_back(open_drive(path, "training", settings)).get());
    });
  }
  const bool learns = !settings.training.empty();
  if (learns && own.empty() && faults.empty())
    say("learning from {}", counted(training.size(), "drive"));
  std::unique_ptr<Describer> describer;
  collect(faults, [&] {
    if (learns && !faults.empty()) {
      collect(own, [&] { static_cast<void>(open_net(settings)); });
      return refuse(std::move(own));
    }
    describer = make(settings, training, std::move(own));
  });
  if (describer) {
    for (std::size_t i = 0; i < drives.size(); ++i) tell_notes(settings.training[i], *drives[i]);
  }
  return describer;
}

}  // namespace seqloop::program
