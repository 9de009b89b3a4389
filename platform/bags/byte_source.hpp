// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace seqloop::bags {

/// No message, and nothing else that a bag holds in one piece, has more.
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30U;

/// Port: bytes that can be read from any place. A file, and in tests memory.
class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  ByteSource(ByteSource&&) = delete;
  ByteSource& operator=(ByteSource&&) = delete;
  virtual ~ByteSource() = default;

  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;

  /// @return false where not all of it is there
  [[nodiscard]] virtual bool read(std::uint64_t place, std::span<std::uint8_t> into) noexcept = 0;
};

/// Throws SetupError: not there, not a file, may not be read.
[[nodiscard]] std::unique_ptr<ByteSource> open_file(const std::filesystem::path& file);

}  // namespace seqloop::bags
