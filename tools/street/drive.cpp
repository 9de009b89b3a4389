// SPDX-License-Identifier: MIT
#include "drive.hpp"

#include <cmath>
#include <utility>

#include "speed.hpp"

namespace seqloop::street {
namespace {

constexpr double kLongDay = 1500.0;  // frames from one light to the other on long drives

}  // namespace

Drive::Drive(Street street, DrivePlan plan)
    : plan_(std::move(plan)),
      path_(street, plan_.legs),
      at_(positions(plan_.frames, path_.length(), plan_.seed)) {}

double Drive::street(std::size_t frame) const noexcept {
  return path_.street_at(leg(frame), at_[frame]);
}

Shot Drive::shot(std::size_t frame) const {
  const auto key = static_cast<std::uint32_t>(hash_of(plan_.seed, 0x73776179));
  const auto t = static_cast<float>(frame % 1'000'003U);
  const auto p = static_cast<float>(at_[frame]);
  // Two waves each: long ones of the driver, short ones of the road.
  const auto sway = [&](float place, float slow, float quick, float lane) {
    return static_cast<double>(0.75F * (noise(place / slow, lane, key) - 0.5F) +
                               0.25F * (noise(place / quick, lane + 10.0F, key) - 0.5F));
  };
  Shot shot;
  shot.position = at_[frame];
  shot.leg = leg(frame);
  shot.lateral = plan_.lateral + 2.0 * plan_.wander * sway(p, 47.0F, 11.0F, 0.5F);
  shot.height = 1.6 + 0.05 * sway(t, 5.0F, 1.7F, 1.5F);
  shot.yaw = 0.06 * sway(p, 23.0F, 3.1F, 2.5F);
  shot.pitch = 0.03 * sway(t, 9.0F, 1.9F, 3.5F);
  shot.roll = 0.02 * sway(t, 13.0F, 2.3F, 4.5F);
  shot.time = static_cast<double>(frame);
  shot.traffic = hash_of(plan_.seed, 0x74726166);
  shot.noise = hash_of(plan_.seed, 0x6e6f6973, frame);
  const double day = std::max(1.0, static_cast<double>(plan_.frames) - 1.0);
  const double turn = day <= kLongDay
                          ? static_cast<double>(frame) / day
                          : 0.5 - 0.5 * std::cos(static_cast<double>(frame) * kPi / kLongDay);
  shot.light = mix(plan_.first, plan_.last, static_cast<float>(turn));
  // Automatic exposure is never quite steady.
  shot.light.exposure *= 1.0F + 0.10F * (noise(t / 31.0F, 5.5F, key) - 0.5F);
  return shot;
}

}  // namespace seqloop::street
