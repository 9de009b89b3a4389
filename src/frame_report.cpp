// SPDX-License-Identifier: MIT
#include "seqloop/frame_report.hpp"

namespace seqloop {

std::string_view name(Gate gate) noexcept {
  switch (gate) {
    case Gate::no_frame:
      return "no_frame";
    case Gate::frame_error:
      return "frame_error";
    case Gate::warming_up:
      return "warming_up";
    case Gate::waiting:
      return "waiting";
    case Gate::no_candidate:
      return "no_candidate";
    case Gate::not_unique:
      return "not_unique";
    case Gate::new_place:
      return "new_place";
    case Gate::unsure:
      return "unsure";
    case Gate::match:
      return "match";
  }
  return "unknown";
}

std::optional<Gate> gate_of(std::string_view name) noexcept {
  for (std::size_t index = 0; index < gates; ++index) {
    const auto gate = static_cast<Gate>(index);
    if (name == seqloop::name(gate)) return gate;
  }
  return std::nullopt;
}

}  // namespace seqloop
