// SPDX-License-Identifier: MIT
#include "program/drives/drives.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "files/text_file.hpp"
#include "program/drives/camera_decoder.hpp"
#include "program/drives/file_decoder.hpp"
#include "program/drives/ros_name.hpp"
#include "program/drives/unit_rows.hpp"
#include "program/options/model_options.hpp"
#include "program/process/database_file.hpp"
#include "program/process/say.hpp"
#include "ros/wall_time.hpp"
#include "seqloop/bags/bag.hpp"
#include "seqloop/bags/bag_source.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/descriptor_source.hpp"
#include "seqloop/opencv/source.hpp"
#include "seqloop/turbojpeg/jpeg_file_decoder.hpp"

namespace seqloop::program {
namespace {

void set_training(std::vector<std::filesystem::path>& drives, std::string_view text) {
  drives.clear();
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    if (end == 0) throw std::invalid_argument("a drive has no name");
    drives.emplace_back(text.substr(0, end));
    if (end == text.size()) return;
    text.remove_prefix(end + 1);
  }
}

std::vector<FileUse> all_read(const std::string& flag,
                              const std::vector<std::filesystem::path>& paths) {
  std::vector<FileUse> uses;
  uses.reserve(paths.size());
  for (const std::filesystem::path& path : paths) uses.push_back({flag, Access::reads, path});
  return uses;
}

/// No more than can be learned from as many pictures and features as are taken.
std::size_t parse_count_to(std::string_view text, std::size_t most) {
  const std::size_t count = parse_count(text);
  if (count > most) {
    throw std::invalid_argument(std::to_string(count) + " is more than " + std::to_string(most));
  }
  return count;
}

/// Refuses a map, which is no drive, before a reader of drives says that it knows no such format,
/// and what has no bytes.
void refuse_no_drive(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  files::refuse_empty(path, "name a drive");
  if (!is_database(path)) return;
  throw SetupError({path.string(), "is a map, or another database, and no drive",
                    "to localise in a map: --map " + path.string() + " --read-only"});
}

}  // namespace

void add_drive_options(OptionTable& options, DriveSettings& settings) {
  options.section("Model");
  options.text("descriptor", settings.descriptor,
               "gradients, patches (SeqSLAM's) or words (of ORB features) [gradients]");
  options.add({"model", ValueKind::text,
               "model file (ONNX, Caffe, TensorFlow, ...) [the built-in descriptor]",
               [&settings](std::string_view value) { settings.model.model = value; },
               [&settings] {
                 return all_read("model",
                                 settings.model.model.empty()
                                     ? std::vector<std::filesystem::path>()
                                     : model_files(settings.model, settings.model_flags_given));
               }});
  options.section("Model", Shown::in_help_all);
  const OptionTable model = model_options(settings.model);
  for (Option option : model.options()) {
    option.set = [&settings, name = option.name, set = option.set](std::string_view value) {
      set(value);
      settings.model_flags_given.push_back(name);
    };
    options.add(std::move(option));
  }
  options.add({"training", ValueKind::text,
               "drives to learn from, image folders or videos, with commas between",
               [&settings](std::string_view value) { set_training(settings.training, value); },
               [&settings] { return all_read("training", settings.training); }});
  options.add(
      {"words", ValueKind::count, "words: size of the vocabulary [500]",
       [&settings](std::string_view value) { settings.words = parse_count_to(value, 20'000); }});
  options.add({"remove-components", ValueKind::count,
               "Change Removal: principal components of the training drives to remove [0]",
               [&settings](std::string_view value) {
                 settings.remove_components.emplace();  // asked for, if wrongly
                 settings.remove_components = parse_count_to(value, 999);
               }});
  options.section("Source");
  options.add({"fps", ValueKind::number,
               "frames a second: of an image folder; of a camera, at least [10]",
               [&settings](std::string_view value) {
                 const double fps = parse_number(value);
                 if (!(fps >= 1e-3 && fps <= 1e6)) {
                   throw std::invalid_argument("a frame rate is between 0.001 and 1000000");
                 }
                 settings.fps = fps;
               }});
  options.text("topic", settings.topic, "of a bag: which pictures [the only topic that has any]");
}

void check_reading(const DriveSettings& settings, std::span<const std::filesystem::path> drives,
                   Faults& faults) {
  const auto may_be_bag = [](const std::filesystem::path& drive) {
    std::error_code error;
    const bool there = is_topic(drive) || std::filesystem::exists(drive, error);
    return !drive.empty() && (!there || bags::is_bag(drive));
  };
  const auto has_no_rate = [](const std::filesystem::path& drive) {
    std::error_code error;
    const bool video = std::filesystem::is_regular_file(drive, error) && !is_described(drive);
    return !drive.empty() && !video && !bags::is_bag(drive);
  };
  if (!settings.topic.empty() && std::ranges::none_of(drives, may_be_bag)) {
    faults.push_back({"topic", "it goes with a bag, and none is given", "leave it out"});
  }
  // A default that is written out is what happens anyway.
  if (settings.fps != DriveSettings{}.fps && std::ranges::none_of(drives, has_no_rate)) {
    faults.push_back({"fps",
                      "it goes with image folders, descriptors and cameras, and none is given",
                      "leave it out"});
  }
}

files::Matrix read_descriptors(const std::filesystem::path& path, Difference difference) {
  refuse_no_drive(path);
  files::Matrix descriptors = files::read_npy(path);
  const std::size_t changed = difference == Difference::euclidean ? normalise_rows(descriptors) : 0;
  if (changed > 0) {
    say("{}: not of unit length, and made so: {} of {}", path.string(), changed,
        counted(descriptors.rows, "row"));
  }
  return descriptors;
}

bool is_described(const std::filesystem::path& path) { return path.extension() == ".npy"; }

std::unique_ptr<FrameSource> open_drive(const std::filesystem::path& path, const std::string& flag,
                                        const DriveSettings& settings, const Describer* describer) {
  if (path.empty()) {
    throw SetupError({flag, "not given", "an image folder, a video, a bag or an .npy file"});
  }
  if (is_described(path)) {
    return std::make_unique<files::DescriptorSource>(read_descriptors(path, settings.difference),
                                                     settings.fps);
  }
  if (bags::is_bag(path)) {
    files::refuse_empty(path, "name a drive");
    return std::make_unique<bags::BagSource>(path, settings.topic, std::make_unique<FileDecoder>());
  }
  refuse_no_drive(path);
  const PictureNeeds needs = describer == nullptr ? PictureNeeds{} : describer->needs();
  return opencv::open_source(path, {.frames_per_second = settings.fps,
                                    .jpeg = std::make_unique<turbojpeg::JpegFileDecoder>(false),
                                    .mjpg = std::make_unique<CameraDecoder>(needs)});
}

std::int64_t start_ns(const FrameSource* recording) noexcept {
  if (recording == nullptr) return ros::wall_ns();
  const auto* bag = dynamic_cast<const bags::BagSource*>(recording);
  return bag == nullptr ? 0 : bag->start_ns();
}

void tell_notes(const std::filesystem::path& path, const FrameSource& source) {
  for (const std::string& note : source.notes()) {
    say("{}: {}", path.string(), note);
  }
}

void tell_blank(const std::filesystem::path& path, std::uint64_t blank, std::uint64_t frames) {
  if (blank == 0) return;
  if (blank < frames) {
    say("{}: {} of {} frames {} blank, without any feature", path.string(), blank, frames,
        are(blank));
  } else {
    say("{}: all frames are blank, without any feature: there is nothing to recognise a place by",
        path.string());
  }
}

}  // namespace seqloop::program
