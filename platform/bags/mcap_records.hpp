// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace seqloop::bags::mcap {

// What the MCAP specification (mcap.dev/spec) calls these, and their numbers.
enum class Opcode : std::uint8_t {
  none = 0x00,
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  summary_offset = 0x0e,
  data_end = 0x0f
};

using Bytes = std::span<const std::uint8_t>;

inline constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t head_bytes = 9;     ///< of a record: its opcode and its length
inline constexpr std::size_t footer_bytes = 20;  ///< of the footer, without its head

/// The check sum of chunks and summaries: CRC-32 as in zlib and Ethernet.
/// @param before that of the bytes before these; 0 where there are none
[[nodiscard]] std::uint32_t checksum(Bytes bytes, std::uint32_t before = 0) noexcept;

/// Reads what a record holds, in order. Beyond its end everything is zero or empty, and `whole` is
/// false from then on.
class Cursor {
 public:
  explicit Cursor(Bytes bytes) noexcept : bytes_(bytes) {}

  template <class Number>
  [[nodiscard]] Number number() noexcept {
    Number value = 0;
    const Bytes taken = take(sizeof(Number));
    for (std::size_t i = taken.size(); i-- > 0;)
      value = static_cast<Number>(static_cast<std::uint64_t>(value) << 8U | taken[i]);
    return value;
  }

  [[nodiscard]] std::string_view text() noexcept {
    const Bytes taken = take(number<std::uint32_t>());
    return {static_cast<const char*>(static_cast<const void*>(taken.data())), taken.size()};
  }

  [[nodiscard]] Bytes take(std::uint64_t count) noexcept {
    if (count > bytes_.size()) {
      whole_ = false;
      bytes_ = {};
      return {};
    }
    const Bytes taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }

  [[nodiscard]] Bytes rest() const noexcept { return bytes_; }
  [[nodiscard]] bool whole() const noexcept { return whole_; }

 private:
  Bytes bytes_;
  bool whole_ = true;
};

struct Record {
  Opcode opcode = Opcode::none;
  Bytes content;
};

/// Takes the first record off. @return nothing where none is whole
[[nodiscard]] std::optional<Record> take_record(Bytes& bytes) noexcept;

struct Schema {
  std::uint16_t id = 0;
  std::string name;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic;
  std::string encoding;
};

struct MessageHead {
  std::uint16_t channel = 0;
  std::uint64_t log_time = 0;  ///< nanoseconds since 1970
  Bytes data;
};

struct ChunkHead {
  std::uint64_t size = 0;  ///< unpacked
  std::uint32_t crc = 0;   ///< of what is unpacked; 0: none
  std::string compression;
  std::uint64_t packed = 0;  ///< bytes that follow
  std::size_t bytes = 0;     ///< of this head
};

struct ChunkIndex {
  std::uint64_t start = 0;              ///< place of the chunk in the file
  std::vector<std::uint16_t> channels;  ///< that have messages in it; none: the writer did not say
};

struct Statistics {
  std::uint64_t all_messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint64_t start = 0;  ///< log times of the first and of the last message
  std::uint64_t end = 0;
  std::vector<std::pair<std::uint16_t, std::uint64_t>>
      messages;  ///< a channel and its count; may be left out
};

// Each is nothing where the record is not whole. Throw std::bad_alloc.
[[nodiscard]] std::optional<Schema> read_schema(Bytes content);
[[nodiscard]] std::optional<Channel> read_channel(Bytes content);
[[nodiscard]] std::optional<MessageHead> read_message(Bytes content);
/// @param content as much of it as there is
[[nodiscard]] std::optional<ChunkHead> read_chunk(Bytes content);
[[nodiscard]] std::optional<ChunkIndex> read_chunk_index(Bytes content);
[[nodiscard]] std::optional<Statistics> read_statistics(Bytes content);

}  // namespace seqloop::bags::mcap
