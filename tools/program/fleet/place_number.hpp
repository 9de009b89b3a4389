// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace seqloop::program {

/// Frames that a session of a fleet may have. Sessions grow side by side there, so a place's number
/// is its session's, times this, and its frame: nobody has to remember which place is which.
constexpr std::uint64_t frames_of_a_session = std::uint64_t{1} << 32U;

/// @param frame below `frames_of_a_session`
[[nodiscard]] constexpr std::uint64_t place_number(std::uint64_t session,
                                                   std::uint64_t frame) noexcept {
  return session * frames_of_a_session + frame;
}
[[nodiscard]] constexpr std::uint64_t session_of(std::uint64_t number) noexcept {
  return number / frames_of_a_session;
}
[[nodiscard]] constexpr std::uint64_t frame_of(std::uint64_t number) noexcept {
  return number % frames_of_a_session;
}

}  // namespace seqloop::program
