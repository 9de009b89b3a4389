// SPDX-License-Identifier: MIT
// Without DDS, no run gets this far: join_ros throws.
#include "program/fleet/fleet.hpp"

namespace seqloop::program {

class Fleet::Impl {};

Fleet::Fleet(const FleetSettings& /*settings*/, std::shared_ptr<dds::Participant> /*participant*/,
             LastingMap& /*map*/, const MatcherConfig& /*config*/, const PlaceMap& /*own*/) {}
Fleet::~Fleet() = default;
void Fleet::step(ProcessedFrame& /*processed*/, Clock& /*clock*/) noexcept {}
void Fleet::finish(std::span<const Answer> /*rest*/) noexcept {}
std::span<const OtherLoop> Fleet::loops() const noexcept { return {}; }
std::size_t Fleet::places() const noexcept { return 0; }
void Fleet::add_to(nlohmann::ordered_json& /*frame*/) const {}
std::optional<std::string> Fleet::trouble() { return std::nullopt; }
std::string Fleet::end() { return {}; }

}  // namespace seqloop::program
