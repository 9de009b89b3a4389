// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace seqloop::opencv {

/// What can be seen from outside to be wrong with a picture file: empty, a JPEG or PNG that was cut
/// off (decoders make a half grey picture of those), a JPEG or PNG of more pixels than a camera
/// has.
/// @return empty when nothing was found; other formats are left to the decoder
[[nodiscard]] std::string_view picture_file_fault(std::span<const std::uint8_t> file) noexcept;

}  // namespace seqloop::opencv
