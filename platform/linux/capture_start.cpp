// SPDX-License-Identifier: MIT
#include "linux/capture_start.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

#include "linux/camera_offer.hpp"
#include "linux/choose_mode.hpp"

namespace seqloop::live {
namespace {

constexpr std::size_t most_attempts = 32;  // settings of the mode, each of which may take long

Refusal refusal(const char* doing, int error) {
  return {error == EBUSY ? Refused::busy : Refused::failed, doing, error, {}, {}};
}

/// Formats with sizes, each once.
std::vector<std::string> names_of(const std::vector<CameraMode>& modes) {
  std::vector<std::string> names;
  for (CameraMode mode : modes) {
    mode.interval_numerator = 0;
    std::string name = to_string(mode);
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

bool as_offered(const CameraMode& given, const CameraMode& offered) noexcept {
  constexpr double tolerance = 0.98;
  return given.fourcc == offered.fourcc && given.width == offered.width &&
         given.height == offered.height &&
         (rate(given) == 0.0 || rate(given) >= rate(offered) * tolerance);
}

/// @return why no mode could be set
Refusal set_best_mode(CaptureStream& stream, const std::vector<CameraMode>& modes,
                      const CameraWish& wish) {
  int first_error = 0;
  const std::size_t attempts = std::min(modes.size(), most_attempts);
  for (const bool strict : {true, false}) {
    for (std::size_t i = 0; i < attempts; ++i) {
      if (const int error = stream.set_mode(modes[i]); error != 0) {
        if (first_error == 0) first_error = error;
        if (error == EBUSY || error == ENODEV) return refusal("S_FMT", error);
        continue;
      }
      const CameraMode& given = stream.mode();
      if (strict ? as_offered(given, modes[i]) : serves(given, wish)) {
        return refusal("S_FMT", 0);
      }
    }
  }
  return refusal("S_FMT", first_error == 0 ? EINVAL : first_error);
}

}  // namespace

std::variant<std::unique_ptr<CaptureStream>, Refusal> start_capture(SystemCalls& system,
                                                                    const std::string& path,
                                                                    const CameraWish& wish,
                                                                    std::uint32_t buffers,
                                                                    std::uint32_t most_out) {
  auto opened = open_node(system, path);
  if (auto* const refused = std::get_if<Refusal>(&opened)) return std::move(*refused);
  auto stream = std::make_unique<CaptureStream>(system, std::move(std::get<VideoNode>(opened)));
  const VideoNode& node = stream->node();
  const CameraOffer offer = read_offer(system, node.fd.get(), node.buffer_type, wish);
  const std::vector<CameraMode> modes = choose_mode(offer.modes, wish);
  if (modes.empty()) {
    if (offer.modes.empty()) {
      return Refusal{Refused::no_format, "ENUM_FMT", 0, {}, offer.other_formats};
    }
    return Refusal{Refused::not_offered, "ENUM_FMT", 0, {}, names_of(offer.modes)};
  }
  if (Refusal refused = set_best_mode(*stream, modes, wish); refused.error != 0) return refused;
  if (const int error = stream->allocate(buffers, most_out); error != 0) {
    Refusal refused = refusal("REQBUFS", error);
    if (error == ENOBUFS) refused.why = Refused::too_few_buffers;
    return refused;
  }
  if (const int error = stream->start(); error != 0) return refusal("STREAMON", error);
  return stream;
}

}  // namespace seqloop::live
