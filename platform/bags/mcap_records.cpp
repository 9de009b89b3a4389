// SPDX-License-Identifier: MIT
#include "bags/mcap_records.hpp"

#include <zlib.h>

namespace seqloop::bags::mcap {
namespace {

template <class Read>
std::optional<Read> whole(const Cursor& cursor, Read read) {
  if (!cursor.whole()) return std::nullopt;
  return read;
}

}  // namespace

std::uint32_t checksum(Bytes bytes, std::uint32_t before) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

std::optional<Record> take_record(Bytes& bytes) noexcept {
  Cursor cursor(bytes);
  const auto opcode = static_cast<Opcode>(cursor.number<std::uint8_t>());
  const Bytes content = cursor.take(cursor.number<std::uint64_t>());
  if (!cursor.whole()) return std::nullopt;
  bytes = cursor.rest();
  return Record{opcode, content};
}

std::optional<Schema> read_schema(Bytes content) {
  Cursor cursor(content);
  const auto id = cursor.number<std::uint16_t>();
  return whole(cursor, Schema{id, std::string(cursor.text())});
}

std::optional<Channel> read_channel(Bytes content) {
  Cursor cursor(content);
  Channel channel;
  channel.id = cursor.number<std::uint16_t>();
  channel.schema = cursor.number<std::uint16_t>();
  channel.topic = cursor.text();
  channel.encoding = cursor.text();
  return whole(cursor, std::move(channel));
}

std::optional<MessageHead> read_message(Bytes content) {
  Cursor cursor(content);
  MessageHead head;
  head.channel = cursor.number<std::uint16_t>();
  static_cast<void>(cursor.number<std::uint32_t>());  // sequence
  head.log_time = cursor.number<std::uint64_t>();
  static_cast<void>(cursor.number<std::uint64_t>());  // publish time
  head.data = cursor.rest();
  return whole(cursor, head);
}

std::optional<ChunkHead> read_chunk(Bytes content) {
  Cursor cursor(content);
  ChunkHead head;
  static_cast<void>(cursor.take(16));  // times of the first and the last message
  head.size = cursor.number<std::uint64_t>();
  head.crc = cursor.number<std::uint32_t>();
  head.compression = cursor.text();
  head.packed = cursor.number<std::uint64_t>();
  head.bytes = content.size() - cursor.rest().size();
  return whole(cursor, std::move(head));
}

std::optional<ChunkIndex> read_chunk_index(Bytes content) {
  Cursor cursor(content);
  ChunkIndex index;
  static_cast<void>(cursor.take(16));
  index.start = cursor.number<std::uint64_t>();
  static_cast<void>(cursor.number<std::uint64_t>());  // length
  Cursor offsets(cursor.take(cursor.number<std::uint32_t>()));
  while (!offsets.rest().empty()) {
    index.channels.push_back(offsets.number<std::uint16_t>());
    static_cast<void>(offsets.number<std::uint64_t>());
  }
  return offsets.whole() ? whole(cursor, std::move(index)) : std::nullopt;
}

std::optional<Statistics> read_statistics(Bytes content) {
  Cursor cursor(content);
  Statistics statistics;
  statistics.all_messages = cursor.number<std::uint64_t>();
  statistics.schemas = cursor.number<std::uint16_t>();
  statistics.channels = cursor.number<std::uint32_t>();
  static_cast<void>(cursor.take(3 * 4));  // counts of attachments, metadata and chunks
  statistics.start = cursor.number<std::uint64_t>();
  statistics.end = cursor.number<std::uint64_t>();
  Cursor counts(cursor.take(cursor.number<std::uint32_t>()));
  while (!counts.rest().empty()) {
    const auto channel = counts.number<std::uint16_t>();
    statistics.messages.emplace_back(channel, counts.number<std::uint64_t>());
  }
  return counts.whole() ? whole(cursor, std::move(statistics)) : std::nullopt;
}

}  // namespace seqloop::bags::mcap
