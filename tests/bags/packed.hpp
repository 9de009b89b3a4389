// SPDX-License-Identifier: MIT
// Packs bytes as writers of MCAP do, with what this build has.
#pragma once

#if SEQLOOP_LZ4
#include <lz4frame.h>
#endif
#if SEQLOOP_ZSTD
#include <zstd.h>
#endif

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace seqloop::test {

/// The compressions that this build knows; the first is none.
inline std::vector<std::string> compressions() {
  std::vector<std::string> names{""};
#if SEQLOOP_LZ4
  names.emplace_back("lz4");
#endif
#if SEQLOOP_ZSTD
  names.emplace_back("zstd");
#endif
  return names;
}

inline std::vector<std::uint8_t> packed(const std::string& compression,
                                        std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> out;
#if SEQLOOP_LZ4
  if (compression == "lz4") {
    out.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
    return out;
  }
#endif
#if SEQLOOP_ZSTD
  if (compression == "zstd") {
    out.resize(ZSTD_compressBound(bytes.size()));
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
    return out;
  }
#endif
  if (!compression.empty()) throw std::runtime_error(compression);
  out.assign(bytes.begin(), bytes.end());
  return out;
}

}  // namespace seqloop::test
