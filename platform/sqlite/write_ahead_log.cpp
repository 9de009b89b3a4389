// SPDX-License-Identifier: MIT
#include "sqlite/write_ahead_log.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "seqloop/sqlite/map_file.hpp"
#include "sqlite/schema.hpp"

namespace seqloop::sqlite {
namespace {

namespace fs = std::filesystem;

std::uint32_t big_endian(std::span<const char> bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.first(4)) value = value << 8U | static_cast<unsigned char>(byte);
  return value;
}

/// The two sums that each frame has of all before it.
using Sums = std::array<std::uint32_t, 2>;

Sums sums_at(std::span<const char> bytes) {
  return {big_endian(bytes), big_endian(bytes.subspan(4))};
}

/// Goes on with the sums of what comes before some bytes, a multiple of 8.
Sums sums_with(Sums sums, std::span<const char> bytes, bool big) {
  const auto word = [&](std::size_t at) {
    const std::uint32_t value = big_endian(bytes.subspan(at));
    return big ? value : __builtin_bswap32(value);
  };
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    sums[0] += word(at) + sums[1];
    sums[1] += word(at + 4) + sums[0];
  }
  return sums;
}

struct LogFrame {
  std::uint32_t page;  ///< number, from 1
  bool ends_batch;
  bool whole;
  std::span<const char> bytes;  ///< of the page
};

using Head = std::array<char, 32>;

/// The head of a log, with which it begins anew; nothing where there is none.
std::optional<Head> head_of(std::istream& log) {
  Head head{};
  if (!log.read(head.data(), head.size())) return std::nullopt;
  return head;
}

/// Hands over the frames that were written since the log began anew, and those that are damaged.
/// Each is looked at by what stands in the one before it: so one that is not whole spoils no other.
/// @return the head of the log; nothing where there is none
std::optional<Head> each_frame(const fs::path& log,
                               const std::function<void(const LogFrame&)>& take) {
  constexpr std::size_t begin_bytes = 24;  // of a frame, before its page
  std::ifstream file(log, std::ios::binary);
  const std::optional<Head> head = head_of(file);
  if (!head) return std::nullopt;
  const std::span<const char> of_head = *head;
  constexpr std::uint32_t magic = 0x377F0682;  // and 1 more where words begin with their high byte
  const bool big = big_endian(of_head) == magic + 1;
  Sums before = sums_at(of_head.subspan(24));
  const bool head_whole = (big || big_endian(of_head) == magic) &&
                          big_endian(of_head.subspan(8)) == page_size &&
                          sums_with({}, of_head.first(24), big) == before;
  // Frames of an earlier time stay behind those that were written since, with another salt.
  Sums salt = sums_at(of_head.subspan(16));
  std::vector<char> frame(begin_bytes + page_size);
  for (bool first = true; file.read(frame.data(), static_cast<std::streamsize>(frame.size()));
       first = false) {
    const std::span<const char> begin = std::span<const char>(frame).first(begin_bytes);
    const std::span<const char> page = std::span<const char>(frame).subspan(begin_bytes);
    if (first && !head_whole) salt = sums_at(begin.subspan(8));
    const Sums sums = sums_with(sums_with(before, begin.first(8), big), page, big);
    before = sums_at(begin.subspan(16));
    take({big_endian(begin), big_endian(begin.subspan(4)) != 0,
          sums == before && sums_at(begin.subspan(8)) == salt && (!first || head_whole), page});
  }
  return head;
}

}  // namespace

bool is_damaged_log(const fs::path& log) {
  constexpr int least = 2;
  bool whole = true;
  int ends = 0;
  const std::optional<Head> head = each_frame(log, [&](const LogFrame& frame) {
    whole = whole && frame.whole;
    if (!whole && frame.whole && frame.ends_batch) ++ends;
  });
  if (ends < least) return false;
  // A writer may have begun it anew meanwhile.
  std::ifstream again(log, std::ios::binary);
  return head_of(again) == head;
}

bool holds_batches(const fs::path& log) {
  bool any = false;
  each_frame(log,
             [&any](const LogFrame& frame) { any = any || (frame.whole && frame.ends_batch); });
  return any;
}

void put_log_into(const fs::path& file, const fs::path& log) {
  std::size_t count = 0;
  std::size_t end = 0;
  each_frame(log, [&](const LogFrame& frame) {
    ++count;
    if (frame.whole && frame.ends_batch) end = count;
  });
  // Each frame makes the file longer by a page at most, whatever stands in it.
  const std::uintmax_t most = fs::file_size(file) / page_size + end;
  std::fstream pages(file, std::ios::binary | std::ios::in | std::ios::out);
  count = 0;
  each_frame(log, [&](const LogFrame& frame) {
    if (++count > end || !frame.whole || frame.page == 0 || frame.page > most) return;
    pages.seekp(static_cast<std::streamoff>(frame.page - 1) * page_size);
    pages.write(frame.bytes.data(), static_cast<std::streamsize>(frame.bytes.size()));
  });
  if (!pages.flush()) throw SaveError(file.string() + ": cannot be written");
}

}  // namespace seqloop::sqlite
