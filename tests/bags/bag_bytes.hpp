// SPDX-License-Identifier: MIT
// Bags and messages put together byte by byte, as the specifications have them, for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bags/byte_source.hpp"
#include "bags/mcap_records.hpp"

namespace seqloop::test {

using ByteVector = std::vector<std::uint8_t>;

/// A message of ROS 2 in either byte order.
class Cdr {
 public:
  explicit Cdr(bool little = true)
      : little_(little), bytes_{0, little ? std::uint8_t{1} : std::uint8_t{0}, 0, 0} {}

  template <class Number>
  Cdr& put(Number value) {
    while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_.push_back(0);
    std::uint8_t raw[sizeof(Number)];
    std::memcpy(raw, &value, sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(raw[little_ ? i : sizeof(Number) - 1 - i]);
    return *this;
  }
  Cdr& text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  Cdr& octets(std::span<const std::uint8_t> octets) {
    put(static_cast<std::uint32_t>(octets.size()));
    bytes_.insert(bytes_.end(), octets.begin(), octets.end());
    return *this;
  }
  Cdr& header(std::int64_t stamp_ns, std::string_view frame = "camera") {
    put(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
    put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    return text(frame);
  }
  [[nodiscard]] const ByteVector& bytes() const { return bytes_; }

 private:
  bool little_;
  ByteVector bytes_;
};

inline ByteVector odometry_message(std::int64_t stamp_ns) {
  Cdr cdr;
  cdr.header(stamp_ns, "odom").text("base_link");
  for (int i = 0; i < 7 + 36 + 6 + 36; ++i) cdr.put(i == 6 ? 1.0 : 0.0);
  return cdr.bytes();
}

inline ByteVector image_message(std::int64_t stamp_ns, std::uint32_t width, std::uint32_t height,
                                std::string_view encoding, std::uint32_t step,
                                std::span<const std::uint8_t> data, bool little = true,
                                bool big_endian_pixels = false) {
  return Cdr(little)
      .header(stamp_ns)
      .put(height)
      .put(width)
      .text(encoding)
      .put(static_cast<std::uint8_t>(big_endian_pixels))
      .put(step)
      .octets(data)
      .bytes();
}

inline ByteVector compressed_message(std::int64_t stamp_ns, std::string_view format,
                                     std::span<const std::uint8_t> data) {
  return Cdr().header(stamp_ns).text(format).octets(data).bytes();
}

/// Records of an MCAP file.
class McapBytes {
 public:
  template <class Number>
  McapBytes& put(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> 8 * i));
    return *this;
  }
  McapBytes& text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
  McapBytes& raw(std::span<const std::uint8_t> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
  McapBytes& record(std::uint8_t opcode, const McapBytes& content) {
    return put(opcode).put(std::uint64_t{content.bytes.size()}).raw(content.bytes);
  }
  McapBytes& magic() {
    return raw(std::vector<std::uint8_t>{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'});
  }
  McapBytes& start() { return magic().record(1, McapBytes().text("ros2").text("by hand")); }
  McapBytes& schema(std::uint16_t id, std::string_view type) {
    return record(3, McapBytes().put(id).text(type).text("ros2msg").text("# none"));
  }
  McapBytes& channel(std::uint16_t id, std::uint16_t schema, std::string_view topic,
                     std::string_view encoding = "cdr") {
    return record(4,
                  McapBytes().put(id).put(schema).text(topic).text(encoding).put(std::uint32_t{0}));
  }
  McapBytes& message(std::uint16_t channel, std::uint64_t time,
                     std::span<const std::uint8_t> data) {
    return record(5, McapBytes().put(channel).put(std::uint32_t{0}).put(time).put(time).raw(data));
  }
  /// @param packed the records as they lie in the file
  McapBytes& chunk(const McapBytes& records, std::string_view compression,
                   std::span<const std::uint8_t> packed) {
    return record(6, McapBytes()
                         .put(std::uint64_t{0})
                         .put(std::uint64_t{0})
                         .put(std::uint64_t{records.bytes.size()})
                         .put(bags::mcap::checksum(records.bytes))
                         .text(compression)
                         .put(std::uint64_t{packed.size()})
                         .raw(packed));
  }
  McapBytes& chunk(const McapBytes& records) { return chunk(records, "", records.bytes); }
  /// @param summary records; none: the file has no summary
  McapBytes& finish(const McapBytes& summary = {}) {
    record(15, McapBytes().put(std::uint32_t{0}));
    const std::uint64_t start = summary.bytes.empty() ? 0 : bytes.size();
    const McapBytes end =
        McapBytes().put(std::uint8_t{2}).put(std::uint64_t{20}).put(start).put(std::uint64_t{0});
    return raw(summary.bytes)
        .raw(end.bytes)
        .put(bags::mcap::checksum(end.bytes, bags::mcap::checksum(summary.bytes)))
        .magic();
  }

  ByteVector bytes;
};

/// A file in memory.
class MemoryBytes : public bags::ByteSource {
 public:
  explicit MemoryBytes(ByteVector bytes) : bytes_(std::move(bytes)) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return bytes_.size(); }
  [[nodiscard]] bool read(std::uint64_t place, std::span<std::uint8_t> into) noexcept override {
    if (place > bytes_.size() || into.size() > bytes_.size() - place) return false;
    if (!into.empty()) std::memcpy(into.data(), bytes_.data() + place, into.size());
    ++reads;
    return true;
  }
  std::size_t reads = 0;

 private:
  ByteVector bytes_;
};

}  // namespace seqloop::test
