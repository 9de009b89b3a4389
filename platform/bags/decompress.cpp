// SPDX-License-Identifier: MIT
#include "bags/decompress.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

#include "bags/byte_source.hpp"

#if SEQLOOP_LZ4
#include <lz4frame.h>
#endif
#if SEQLOOP_ZSTD
#include <zstd.h>
#endif

namespace seqloop::bags {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view damaged = "a chunk cannot be unpacked";
constexpr std::string_view cut_off = "a chunk is cut off";
constexpr std::string_view another_size = "a chunk unpacks to another size than it says";
constexpr std::string_view too_large = "a chunk says that it has more than 1 GiB";

/// One step of unpacking: `in` and `out` are moved on by what was used of them.
enum class Step : std::uint8_t { goes_on, done, failed };

/// Takes steps until all is out that was promised. @param step bool(Bytes& in, span& out)
template <class Take>
Decompressed unpack(Bytes packed, std::uint64_t size, std::vector<std::uint8_t>& buffer,
                    Take take) {
  constexpr std::size_t first_room = 65'536;
  if (size > most_bytes) return {{}, too_large};
  std::size_t filled = 0;
  Step step = Step::goes_on;
  while (step == Step::goes_on) {
    if (filled == buffer.size())
      // One byte more than promised, so that what is longer is seen.
      buffer.resize(
          std::min(static_cast<std::size_t>(size) + 1, std::max(first_room, 2 * buffer.size())));
    const std::size_t left = packed.size();
    std::span<std::uint8_t> room = std::span(buffer).subspan(
        filled, std::min(buffer.size(), static_cast<std::size_t>(size) + 1) - filled);
    const std::size_t space = room.size();
    step = take(packed, room);
    filled += space - room.size();
    if (step == Step::failed)
      return {Bytes(buffer).first(std::min(filled, static_cast<std::size_t>(size))), damaged};
    if (filled > size) return {Bytes(buffer).first(static_cast<std::size_t>(size)), another_size};
    if (step == Step::goes_on && packed.size() == left && room.size() == space)
      return {Bytes(buffer).first(filled), cut_off};
  }
  return {Bytes(buffer).first(filled), filled == size ? std::string_view{} : another_size};
}

#if SEQLOOP_LZ4
struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const noexcept { LZ4F_freeDecompressionContext(context); }
};

Decompressed unpack_lz4(Bytes packed, std::uint64_t size, std::vector<std::uint8_t>& buffer) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0)
    throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(made);
  return unpack(packed, size, buffer, [&](Bytes& in, std::span<std::uint8_t>& out) {
    std::size_t used = in.size();
    std::size_t written = out.size();
    const std::size_t hint =
        LZ4F_decompress(context.get(), out.data(), &written, in.data(), &used, nullptr);
    if (LZ4F_isError(hint) != 0) return Step::failed;
    in = in.subspan(used);
    out = out.subspan(written);
    return hint == 0 && in.empty() ? Step::done : Step::goes_on;
  });
}
#endif

#if SEQLOOP_ZSTD
struct FreeZstd {
  void operator()(ZSTD_DCtx* context) const noexcept { ZSTD_freeDCtx(context); }
};

Decompressed unpack_zstd(Bytes packed, std::uint64_t size, std::vector<std::uint8_t>& buffer) {
  const std::unique_ptr<ZSTD_DCtx, FreeZstd> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  return unpack(packed, size, buffer, [&](Bytes& in, std::span<std::uint8_t>& out) {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &to, &from);
    if (ZSTD_isError(hint) != 0) return Step::failed;
    in = in.subspan(from.pos);
    out = out.subspan(to.pos);
    return hint == 0 && in.empty() ? Step::done : Step::goes_on;
  });
}
#endif

}  // namespace

Decompressed decompress(std::string_view compression, Bytes packed, std::uint64_t size,
                        [[maybe_unused]] std::vector<std::uint8_t>& buffer) {
  if (compression.empty()) {
    if (packed.size() == size) return {packed, {}};
    return {packed.first(static_cast<std::size_t>(std::min<std::uint64_t>(packed.size(), size))),
            packed.size() < size ? cut_off : another_size};
  }
  if (compression == "lz4") {
#if SEQLOOP_LZ4
    return unpack_lz4(packed, size, buffer);
#else
    return {{}, "a chunk is packed with LZ4, and this build has no liblz4"};
#endif
  }
  if (compression == "zstd") {
#if SEQLOOP_ZSTD
    return unpack_zstd(packed, size, buffer);
#else
    return {{}, "a chunk is packed with Zstandard, and this build has no libzstd"};
#endif
  }
  return {{}, "a chunk is packed in a way that is not known"};
}

}  // namespace seqloop::bags
