// SPDX-License-Identifier: MIT
#include "sqlite/raw_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace seqloop::sqlite {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t file_header = 100;  // before the first page's own
constexpr std::byte leaf_of_table{0x0D};
constexpr std::size_t most_columns = 16;
constexpr std::size_t most_payload = std::size_t{1} << 28U;

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = (value << 8U) | std::to_integer<std::uint64_t>(byte);
  return value;
}

/// Takes a number of 1 to 9 bytes from the front.
std::optional<std::uint64_t> take_varint(Bytes& from) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 9 && i < from.size(); ++i) {
    const auto byte = std::to_integer<std::uint64_t>(from[i]);
    if (i == 8 || byte < 0x80U) {
      value = i == 8 ? (value << 8U) | byte : (value << 7U) | byte;
      from = from.subspan(i + 1);
      return value;
    }
    value = (value << 7U) | (byte & 0x7FU);
  }
  return std::nullopt;
}

std::uint64_t bytes_of(std::uint64_t type) {
  constexpr std::array<std::uint8_t, 12> sizes{0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0};
  return type < sizes.size() ? sizes[static_cast<std::size_t>(type)] : (type - 12) / 2;
}

RawValue value_of(std::uint64_t type, Bytes bytes) {
  using Type = RawValue::Type;
  if (type >= 12) return {type % 2 == 0 ? Type::blob : Type::text, 0, 0.0, bytes};
  if (type == 0) return {};
  if (type == 7) return {Type::real, 0, std::bit_cast<double>(big_endian(bytes))};
  if (type >= 8) return {Type::integer, static_cast<std::int64_t>(type) - 8};
  // Of negative numbers the upper bytes are all ones.
  const auto unused = static_cast<unsigned>(64 - 8 * bytes.size());
  return {Type::integer, std::bit_cast<std::int64_t>(big_endian(bytes) << unused) >> unused};
}

/// @return whether the payload is a row
bool split(Bytes payload, std::vector<RawValue>& columns) {
  columns.clear();
  Bytes types = payload;
  const std::optional<std::uint64_t> header = take_varint(types);
  const std::size_t used = payload.size() - types.size();
  if (!header || *header < used || *header > payload.size()) return false;
  Bytes values = payload.subspan(static_cast<std::size_t>(*header));
  types = types.first(static_cast<std::size_t>(*header) - used);
  while (!types.empty()) {
    const std::optional<std::uint64_t> type = take_varint(types);
    if (!type || *type == 10 || *type == 11 || columns.size() == most_columns) return false;
    if (bytes_of(*type) > values.size()) return false;
    const auto size = static_cast<std::size_t>(bytes_of(*type));
    columns.push_back(value_of(*type, values.first(size)));
    values = values.subspan(size);
  }
  return values.empty();
}

}  // namespace

RawRows::RawRows(const std::filesystem::path& path, std::size_t page_bytes)
    : file_(path, std::ios::binary),
      size_(page_bytes),
      pages_(std::filesystem::file_size(path) / page_bytes) {}

bool RawRows::load(std::uint32_t number, std::vector<std::byte>& page) {
  if (number == 0 || number > pages_) return false;
  page.resize(size_);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(std::uint64_t{number - 1} * size_));
  file_.read(reinterpret_cast<char*>(page.data()), static_cast<std::streamsize>(size_));
  return static_cast<std::size_t>(file_.gcount()) == size_;
}

void RawRows::each(const Take& take) {
  for (std::uint32_t number = 1; number <= pages_; ++number) {
    if (!load(number, page_)) continue;
    loaded_ = number;
    const std::size_t header = number == 1 ? file_header : 0;
    if (page_[header] != leaf_of_table) continue;
    const auto cells = static_cast<std::size_t>(big_endian(Bytes(page_).subspan(header + 3, 2)));
    for (std::size_t i = 0; i < cells; ++i) {
      const std::size_t pointer = header + 8 + 2 * i;
      if (pointer + 2 > size_) break;
      row({number, static_cast<std::size_t>(big_endian(Bytes(page_).subspan(pointer, 2)))}, take);
    }
  }
}

bool RawRows::again(const RawPlace& place, const Take& take) {
  if (loaded_ != place.page && !load(place.page, page_)) return false;
  loaded_ = place.page;
  return row(place, take);
}

bool RawRows::row(const RawPlace& place, const Take& take) {
  if (place.cell >= size_) return false;
  Bytes cell = Bytes(page_).subspan(place.cell);
  const std::optional<std::uint64_t> length = take_varint(cell);
  const std::optional<std::uint64_t> rowid = take_varint(cell);
  if (!length || !rowid || *length > most_payload || *length > pages_ * size_) return false;
  const auto total = static_cast<std::size_t>(*length);
  // What stays in the leaf of a row that does not fit in.
  const std::size_t most_local = size_ - 35;
  const std::size_t least_local = (size_ - 12) * 32 / 255 - 23;
  std::size_t local = total;
  if (total > most_local) {
    local = least_local + (total - least_local) % (size_ - 4);
    if (local > most_local) local = least_local;
  }
  if (cell.size() < local + (total > local ? 4 : 0)) return false;
  payload_.assign(cell.begin(), cell.begin() + static_cast<std::ptrdiff_t>(local));
  auto next = total > local ? static_cast<std::uint32_t>(big_endian(cell.subspan(local, 4))) : 0U;
  while (payload_.size() < total) {
    if (!load(next, overflow_)) return false;
    next = static_cast<std::uint32_t>(big_endian(Bytes(overflow_).first(4)));
    const std::size_t more = std::min(total - payload_.size(), size_ - 4);
    payload_.insert(payload_.end(), overflow_.begin() + 4,
                    overflow_.begin() + 4 + static_cast<std::ptrdiff_t>(more));
  }
  if (!split(payload_, columns_)) return false;
  take(place, std::bit_cast<std::int64_t>(*rowid), columns_);
  return true;
}

}  // namespace seqloop::sqlite
