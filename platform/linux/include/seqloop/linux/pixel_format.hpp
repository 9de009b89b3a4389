// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "seqloop/raw_picture.hpp"

namespace seqloop::live {

/// How V4L2's format lays out its pixels; nothing where no decoder can read it. `JPEG` is `mjpg`.
[[nodiscard]] std::optional<RawFormat> readable(std::uint32_t fourcc) noexcept;

/// Its four characters, `YUYV`; unprintable ones as `?`, big-endian ones with `-BE` behind.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

/// The format with this name, `YUYV`, small or capital letters.
[[nodiscard]] std::optional<RawFormat> format_named(std::string_view name) noexcept;

/// Bytes from which a whole picture can be taken: all but what pads the last row.
[[nodiscard]] std::size_t least_bytes(RawFormat format, std::size_t stride, int width,
                                      int height) noexcept;

}  // namespace seqloop::live
