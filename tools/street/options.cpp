// SPDX-License-Identifier: MIT
#include "options.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

namespace seqloop::street {
namespace {

/// Reads "WIDTHxHEIGHT" and nothing else.
bool read_size(const std::string& text, int& width, int& height) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != 'x') return false;
  const auto second = std::from_chars(first.ptr + 1, end, height);
  return second.ec == std::errc{} && second.ptr == end;
}

bool fits(int pixels) { return pixels >= Options::kLeastPixels && pixels <= Options::kMostPixels; }

}  // namespace

std::optional<Job> check(const Options& o, std::vector<std::string>& faults) {
  const std::size_t before = faults.size();
  Job job;
  if (o.out.empty()) faults.push_back("--out: missing");
  if (o.frames < 1 || o.frames > Options::kMostFrames) {
    faults.push_back("--frames " + std::to_string(o.frames) + ": not in 1.." +
                     std::to_string(Options::kMostFrames));
  }
  if (o.drives != "localise" && o.drives != "loop") {
    faults.push_back("--drives " + o.drives + ": not localise or loop");
  }
  if (!read_size(o.size, job.width, job.height)) {
    faults.push_back("--size " + o.size + ": not WIDTHxHEIGHT");
  } else if (!fits(job.width) || !fits(job.height)) {
    faults.push_back("--size " + o.size + ": width and height must be in " +
                     std::to_string(Options::kLeastPixels) + ".." +
                     std::to_string(Options::kMostPixels));
  }
  if (o.format != "jpg" && o.format != "png" && o.format != "avi") {
    faults.push_back("--format " + o.format + ": not jpg, png or avi");
  }
  job.frames = o.frames;
  job.length = o.length > 0.0 ? o.length : static_cast<double>(o.frames);
  const double step = job.length / static_cast<double>(std::max<std::size_t>(1, o.frames));
  if (!(o.length >= 0.0) || (o.frames > 0 && (step < 0.2 || step > 5.0))) {
    std::ostringstream text;
    text << "--length " << o.length << ": not 0.2..5 metres a frame";
    faults.push_back(text.str());
  }
  job.drives = o.drives == "loop" ? Drives::loop : Drives::localise;
  job.format = o.format == "avi" ? Format::avi : (o.format == "png" ? Format::png : Format::jpg);
  job.seed = o.seed;
  job.kidnaps = o.kidnaps;
  const std::string second =
      !o.second_light.empty() ? o.second_light : (o.drives == "loop" ? "evening" : "winter");
  const auto light = [&](const char* flag, const std::string& name) {
    const std::optional<Light> found = light_named(name);
    if (!found) faults.push_back(std::string(flag) + ' ' + name + ": not " + light_names());
    return found.value_or(Light{});
  };
  job.first = light("--first-light", o.first_light);
  job.second = light("--second-light", second);
  if (o.kidnaps > 0 && o.drives != "loop") {
    faults.push_back("--kidnaps: only with --drives loop");
  } else if (o.kidnaps > 0 && faults.size() == before) {
    const std::size_t most = count_kidnaps(loop_plan(job).legs);
    if (most < o.kidnaps) {
      faults.push_back("--kidnaps " + std::to_string(o.kidnaps) + ": only " + std::to_string(most) +
                       " fit; take more --frames");
    }
  }
  if (faults.size() != before) return std::nullopt;
  std::ostringstream text;
  text.precision(17);
  text << "drives " << o.drives << "\nframes " << job.frames << "\nseed " << job.seed << "\nsize "
       << job.width << 'x' << job.height << "\nformat " << o.format << "\nlength " << job.length
       << "\nkidnaps " << job.kidnaps << "\nfirst-light " << o.first_light << "\nsecond-light "
       << second << '\n';
  job.parameters = text.str();
  return job;
}

DrivePlan localise_plan(const Job& job, bool again) {
  DrivePlan plan;
  plan.legs = {{0.0, job.length, true, false}};
  plan.frames = job.frames;
  plan.seed = hash_of(job.seed, again ? 0x71756572 : 0x72656665);
  plan.first = plan.last = again ? job.second : job.first;
  plan.lateral = again ? -1.5 : -1.9;
  plan.wander = again ? 0.3 : 0.25;
  return plan;
}

DrivePlan loop_plan(const Job& job) {
  DrivePlan plan;
  plan.legs = loop_legs(Street(job.seed), job.frames, job.length, job.kidnaps);
  plan.frames = job.frames;
  plan.seed = hash_of(job.seed, 0x6c6f6f70);
  plan.first = job.first;
  plan.last = job.second;
  plan.lateral = -1.7;
  plan.wander = 0.6;
  return plan;
}

}  // namespace seqloop::street
