// SPDX-License-Identifier: MIT
#include "sqlite/schema.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sqlite/little_endian.hpp"

namespace seqloop::sqlite {

std::vector<std::byte> encode_records(std::span<const PlaceRecord> records) {
  std::vector<std::byte> bytes(records.size() * record_bytes);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::span<std::byte> record = std::span(bytes).subspan(i * record_bytes, record_bytes);
    store_u64(records[i].number, record);
    store_u64(records[i].frame, record.subspan(8));
    store_u64(std::bit_cast<std::uint64_t>(records[i].time_ns), record.subspan(16));
  }
  return bytes;
}

std::vector<PlaceRecord> decode_records(std::span<const std::byte> bytes) {
  std::vector<PlaceRecord> records(bytes.size() / record_bytes);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::span<const std::byte> record = bytes.subspan(i * record_bytes, record_bytes);
    records[i] = {load_u64(record), load_u64(record.subspan(8)),
                  std::bit_cast<std::int64_t>(load_u64(record.subspan(16)))};
  }
  return records;
}

std::vector<std::byte> encode_doubles(std::span<const double> values) {
  std::vector<std::byte> bytes(values.size() * 8);
  for (std::size_t i = 0; i < values.size(); ++i) {
    store_u64(std::bit_cast<std::uint64_t>(values[i]), std::span(bytes).subspan(i * 8, 8));
  }
  return bytes;
}

bool fits(const SavedStatistics& statistics, std::uint64_t descriptor_size) {
  const auto is_number = [](double value) { return std::isfinite(value); };
  const auto is_variance = [&](double value) { return is_number(value) && value >= 0.0; };
  return statistics.mean.size() == statistics.variance.size() &&
         (descriptor_size == 0 || statistics.mean.size() == descriptor_size) &&
         std::ranges::all_of(statistics.mean, is_number) &&
         std::ranges::all_of(statistics.variance, is_variance);
}

std::vector<double> decode_doubles(std::span<const std::byte> bytes) {
  std::vector<double> values(bytes.size() / 8);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::bit_cast<double>(load_u64(bytes.subspan(i * 8, 8)));
  }
  return values;
}

bool BlockRow::whole(const MapForm& form) const {
  if (sum() != checksum || session < 1 || count < 1) return false;
  const auto places_here = static_cast<std::uint64_t>(count);
  if (records.size() / record_bytes != places_here || records.size() % record_bytes != 0) {
    return false;
  }
  return places.size() / form.place_bytes == places_here && places.size() % form.place_bytes == 0 &&
         load_u64(records) == static_cast<std::uint64_t>(first);
}

}  // namespace seqloop::sqlite
