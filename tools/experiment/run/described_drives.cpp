// SPDX-License-Identifier: MIT
#include "experiment/run/described_drives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <utility>

#include "experiment/run/fingerprint.hpp"
#include "program/drives/describe_drive.hpp"
#include "program/drives/known_length.hpp"
#include "program/drives/unit_rows.hpp"
#include "program/options/flag_names.hpp"
#include "program/options/model_options.hpp"
#include "program/options/verb.hpp"
#include "program/process/build_info.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::experiment {
namespace {

/// Runs a part of the check; its faults get the section's line in front.
template <class Part>
void collect_at(const std::string& where, Faults& faults, Part part) {
  Faults found;
  program::collect(found, part);
  for (const Fault& fault : found) {
    faults.push_back({where, fault.what + ": " + fault.why, fault.remedy});
  }
}

}  // namespace

DescribedDrives::DescribedDrives(const Experiment& experiment, std::filesystem::path folder)
    : experiment_(experiment), folder_(std::move(folder)) {}

std::unique_ptr<FrameSource> DescribedDrives::open_whole(const DriveSpec& spec) {
  if (program::is_described(spec.source)) {
    throw SetupError(Fault{spec.source.string(), "holds descriptors already",
                           "give an image folder or a video"});
  }
  program::DriveSettings settings;
  settings.fps = spec.fps;
  return program::open_drive(spec.source, "source", settings);
}

std::unique_ptr<FrameSource> DescribedDrives::open(const std::string& drive) const {
  const DriveSpec& spec = experiment_.drive(drive);
  return make_stills(open_whole(spec), spec.stills);
}

void DescribedDrives::check(Faults& faults) {
  std::map<std::string, std::string> states;  // of drives
  for (const DriveSpec& drive : experiment_.drives) {
    if (drive.source.empty()) continue;
    collect_at(drive.where, faults, [&] {
      std::unique_ptr<FrameSource> whole = open_whole(drive);
      const bool sure = program::known_length(*whole).has_value();
      lengths_[drive.name] = {make_stills(std::move(whole), drive.stills)->frame_count(), sure};
      states[drive.name] = text_of(drive.settings) + drive.source.string() + state_of(drive.source);
    });
  }
  std::set<Wanted> wanted;
  for (const RunSpec& run : experiment_.runs) {
    const PairSpec& pair = experiment_.pairs[run.pair];
    for (const std::string& query : pair.queries) wanted.insert({query, run.descriptor});
    if (!pair.reference.empty()) wanted.insert({pair.reference, run.descriptor});
  }
  std::vector<std::string> made_from(experiment_.descriptors.size());
  for (std::size_t i = 0; i < made_from.size(); ++i) {
    const DescriptorSpec& descriptor = experiment_.descriptors[i];
    if (!descriptor.described.empty()) {
      std::error_code error;
      if (std::filesystem::is_directory(descriptor.described, error)) continue;
      faults.push_back({descriptor.where, descriptor.described.string() + " is no folder",
                        "name one with a file DRIVE.npy for each drive"});
      continue;
    }
    collect_at(descriptor.where, faults, [&] {
      const program::DriveSettings& describer = descriptor.describer;
      program::check_describer(describer, !descriptor.training.empty());
      made_from[i] = text_of(descriptor.settings);
      for (const std::filesystem::path& path :
           program::model_files(describer.model, describer.model_flags_given)) {
        made_from[i] += path.string() + state_of(path);
      }
      for (const std::string& name : descriptor.training) made_from[i] += states[name];
    });
  }
  check_rows(wanted, states, faults);
  check_pictures(wanted, faults);
  for (const Wanted& each : wanted) {
    const std::string& descriptor = experiment_.descriptors[each.descriptor].name;
    if (files_.contains(each)) continue;
    const std::string all =
        program::program_state() + "\n" + states[each.drive] + "\n" + made_from[each.descriptor];
    const std::string name = fmt::format("{}--{}--{}.npy", file_name(each.drive),
                                         file_name(descriptor), fingerprint(all));
    files_[each] = {folder_ / name, name};
  }
}

std::size_t DescribedDrives::look_at(const Wanted& wanted, const std::string& pictures) {
  const DescriptorSpec& descriptor = experiment_.descriptors[wanted.descriptor];
  const std::filesystem::path file = descriptor.described / (wanted.drive + ".npy");
  files_[wanted] = {file, {}};
  // Tells once what is not of unit length, too.
  const files::Matrix rows = program::read_descriptors(file, Difference::euclidean);
  const auto known = lengths_.find(wanted.drive);
  if (known == lengths_.end()) {
    lengths_[wanted.drive] = {rows.rows, true};
  } else if (known->second.sure && known->second.frames != rows.rows) {
    throw SetupError({file.string(),
                      fmt::format("it has {}, and drive '{}' has {}", counted(rows.rows, "row"),
                                  wanted.drive, counted(*known->second.frames, "frame")),
                      "describe the same frames, one row each"});
  }
  files_[wanted].made_from =
      fmt::format("{}\n{}{}\n{}", descriptor.name, file.string(), state_of(file), pictures);
  return rows.columns;
}

/// Drives that are matched, and were described elsewhere, must have been described by the same.
void DescribedDrives::check_rows(const std::set<Wanted>& wanted,
                                 std::map<std::string, std::string>& states, Faults& faults) {
  using Drives = std::map<std::size_t, std::string>;  // one for each number of values in a row
  std::map<std::size_t, Drives> sizes;                // by descriptor
  for (const Wanted& each : wanted) {
    const DescriptorSpec& descriptor = experiment_.descriptors[each.descriptor];
    if (descriptor.described.empty()) continue;
    collect_at(descriptor.where, faults, [&] {
      const std::size_t values = look_at(each, states[each.drive]);
      sizes[each.descriptor].emplace(values, each.drive);
    });
  }
  for (const auto& [index, drives] : sizes) {
    const auto& one = *drives.begin();
    const auto& other = *drives.rbegin();
    const DescriptorSpec& descriptor = experiment_.descriptors[index];
    for (const RunSpec& run : experiment_.runs) {
      if (run.descriptor != index) continue;
      Faults found = validate(Capacity{1, other.first}, run.config);
      if (found.empty()) continue;
      for (Fault& fault : found) fault = program::in_flags(std::move(fault));
      collect_at(descriptor.where, faults, [&] { program::refuse(found); });
      break;
    }
    if (drives.size() < 2) continue;
    faults.push_back({descriptor.where,
                      fmt::format("descriptor '{}': {} in a row of drive '{}', {} in one of '{}'",
                                  descriptor.name, counted(one.first, "value"), one.second,
                                  other.first, other.second),
                      "describe all drives by the same"});
  }
}

/// Only what was described elsewhere needs no pictures.
void DescribedDrives::check_pictures(const std::set<Wanted>& wanted, Faults& faults) const {
  std::set<std::string> told;
  const auto want = [&](const std::string& name, const std::string& who) {
    const DriveSpec& drive = experiment_.drive(name);
    if (!drive.source.empty() || !told.insert(name).second) return;
    faults.push_back({drive.where,
                      fmt::format("drive '{}' has no source, and {} wants its pictures", name, who),
                      "give a source, or a [[descriptor]] with 'described'"});
  };
  for (const Wanted& each : wanted) {
    const DescriptorSpec& descriptor = experiment_.descriptors[each.descriptor];
    const std::string who = "descriptor '" + descriptor.name + "'";
    if (descriptor.described.empty()) want(each.drive, who);
    for (const std::string& drive : descriptor.training) want(drive, who);
  }
  for (const DriveSpec& drive : experiment_.drives) {
    const bool known =
        !drive.source.empty() || lengths_.contains(drive.name) || told.contains(drive.name);
    if (known ||
        std::ranges::any_of(wanted, [&](const Wanted& of) { return of.drive == drive.name; }))
      continue;
    faults.push_back({drive.where, "drive '" + drive.name + "' has no source"});
  }
  for (const PairSpec& pair : experiment_.pairs) {
    // One that closes loops is refused.
    if (!pair.leave_out || pair.reference.empty()) continue;
    for (const std::string& drive : {pair.reference, pair.queries.front()}) {
      want(drive, "pair '" + pair.name + "'");
    }
  }
}

std::vector<Job> DescribedDrives::jobs() const {
  std::vector<Job> jobs;
  for (const auto& [wanted, made] : files_) {
    const DescriptorSpec& descriptor = experiment_.descriptors[wanted.descriptor];
    if (!descriptor.described.empty() || std::filesystem::exists(made.file)) continue;
    std::string name = wanted.drive + " by " + descriptor.name;
    for (const Setting& setting : descriptor.swept)
      name += " " + setting.name + " " + setting.value;
    // A net takes some ten times as long as what is built in.
    const double a_frame = descriptor.describer.model.model.empty() ? 1.0 : 10.0;
    jobs.push_back({name, static_cast<double>(about(wanted.drive)) * a_frame,
                    [this, wanted = wanted] { describe(wanted); }});
  }
  return jobs;
}

std::optional<std::uint64_t> DescribedDrives::length(const std::string& drive) const {
  const auto found = lengths_.find(drive);
  return found != lengths_.end() && found->second.sure ? found->second.frames : std::nullopt;
}

std::uint64_t DescribedDrives::about(const std::string& drive) const {
  constexpr std::uint64_t some = 1'000;
  const auto found = lengths_.find(drive);
  return found == lengths_.end() ? some : found->second.frames.value_or(some);
}

std::filesystem::path DescribedDrives::file(const std::string& drive,
                                            std::size_t descriptor) const {
  return files_.at({drive, descriptor}).file;
}

const std::string& DescribedDrives::made_from(const std::string& drive,
                                              std::size_t descriptor) const {
  return files_.at({drive, descriptor}).made_from;
}

files::Matrix DescribedDrives::read(const std::string& drive, std::size_t descriptor) const {
  const std::filesystem::path made = file(drive, descriptor);
  if (!experiment_.descriptors[descriptor].described.empty()) {
    files::Matrix rows = files::read_npy(made);
    program::normalise_rows(rows);
    return rows;
  }
  try {
    return files::read_npy(made);
  } catch (const SetupError& error) {
    throw SetupError({made.string(), error.faults().front().why,
                      "delete it, and the same command makes it again"});
  }
}

void DescribedDrives::describe(const Wanted& wanted) const {
  const DescriptorSpec& descriptor = experiment_.descriptors[wanted.descriptor];
  std::vector<std::unique_ptr<FrameSource>> training;
  std::vector<FrameSource*> lent;
  for (const std::string& drive : descriptor.training) {
    lent.push_back(training.emplace_back(open(drive)).get());
  }
  // OpenCV keeps its log level and its threads for the whole process.
  static std::mutex opening;
  std::unique_lock lock(opening);
  const auto describer = open_describer(descriptor.describer, lent);
  lock.unlock();
  const auto source = open(wanted.drive);
  files::NpyWriter out(file(wanted.drive, wanted.descriptor), describer->size());
  program::Progress silent;
  program::describe_drive(
      wanted.drive, *source, *describer, [&out](std::span<const float> row) { out.append(row); },
      silent);
  out.commit();
}

}  // namespace seqloop::experiment
