// SPDX-License-Identifier: MIT
#include "bags/mcap_writer.hpp"

#include <algorithm>

#include "bags/mcap_records.hpp"

namespace seqloop::bags {
namespace {

using mcap::Opcode;

constexpr std::size_t chunk_bytes = 1 << 18;
constexpr std::uint16_t only = 1;  // the number of the schema, and of the channel

/// What a record holds, put together.
class Content {
 public:
  template <class Number>
  Content& number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> 8 * i));
    return *this;
  }
  Content& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return *this;
  }
  Content& raw(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  Content& record(Opcode opcode, const Content& content) {
    return number(static_cast<std::uint8_t>(opcode))
        .number(std::uint64_t{content.bytes_.size()})
        .raw(content.bytes_);
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

McapWriter::McapWriter(Write write, const Topic& topic) : write_(std::move(write)) {
  constexpr std::string_view key = "offered_qos_profiles";
  const Content metadata = Content().text(key).text("");
  definitions_ =
      Content()
          .record(Opcode::schema,
                  Content().number(only).text(topic.type).text("ros2msg").text(topic.definition))
          .record(Opcode::channel, Content()
                                       .number(only)
                                       .number(only)
                                       .text(topic.name)
                                       .text("cdr")
                                       .number(static_cast<std::uint32_t>(metadata.bytes().size()))
                                       .raw(metadata.bytes()))
          .bytes();
  put(Content()
          .raw(mcap::magic)
          .record(Opcode::header, Content().text("ros2").text("seqloop"))
          .raw(definitions_)
          .bytes());
}

void McapWriter::add(std::int64_t time_ns, std::span<const std::uint8_t> message) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  chunk_.index.emplace_back(time, chunk_.records.size());
  const Content record =
      Content().record(Opcode::message, Content()
                                            .number(only)
                                            .number(static_cast<std::uint32_t>(messages_++))
                                            .number(time)
                                            .number(time)
                                            .raw(message));
  chunk_.records.insert(chunk_.records.end(), record.bytes().begin(), record.bytes().end());
  chunk_.first = std::min(chunk_.first, time);
  chunk_.last = std::max(chunk_.last, time);
  if (chunk_.records.size() >= chunk_bytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.index.empty()) return;
  const std::uint64_t size = chunk_.records.size();
  const Content chunk = Content().record(Opcode::chunk, Content()
                                                            .number(chunk_.first)
                                                            .number(chunk_.last)
                                                            .number(size)
                                                            .number(mcap::checksum(chunk_.records))
                                                            .text("")
                                                            .number(size)
                                                            .raw(chunk_.records));
  Content times;
  for (const auto& [time, offset] : chunk_.index) times.number(time).number(offset);
  const Content index = Content().record(
      Opcode::message_index, Content()
                                 .number(only)
                                 .number(static_cast<std::uint32_t>(times.bytes().size()))
                                 .raw(times.bytes()));
  const Content offsets =
      Content().number(only).number(place_ + std::uint64_t{chunk.bytes().size()});
  const Content summary = Content().record(
      Opcode::chunk_index, Content()
                               .number(chunk_.first)
                               .number(chunk_.last)
                               .number(place_)
                               .number(std::uint64_t{chunk.bytes().size()})
                               .number(static_cast<std::uint32_t>(offsets.bytes().size()))
                               .raw(offsets.bytes())
                               .number(std::uint64_t{index.bytes().size()})
                               .text("")
                               .number(size)
                               .number(size));
  chunk_indexes_.insert(chunk_indexes_.end(), summary.bytes().begin(), summary.bytes().end());
  put(chunk.bytes());
  put(index.bytes());
  first_ = std::min(first_, chunk_.first);
  last_ = std::max(last_, chunk_.last);
  ++chunks_;
  chunk_ = {};
}

void McapWriter::finish() {
  end_chunk();
  put(Content().record(Opcode::data_end, Content().number(std::uint32_t{0})).bytes());
  const std::uint64_t start = place_;
  const Content counts = Content().number(only).number(messages_);
  Content end;
  end.raw(definitions_)
      .record(Opcode::statistics, Content()
                                      .number(messages_)
                                      .number(std::uint16_t{1})
                                      .number(std::uint32_t{1})
                                      .number(std::uint32_t{0})
                                      .number(std::uint32_t{0})
                                      .number(chunks_)
                                      .number(messages_ == 0 ? std::uint64_t{0} : first_)
                                      .number(last_)
                                      .number(static_cast<std::uint32_t>(counts.bytes().size()))
                                      .raw(counts.bytes()))
      .raw(chunk_indexes_)
      .number(static_cast<std::uint8_t>(Opcode::footer))
      .number(std::uint64_t{mcap::footer_bytes})
      .number(start)
      .number(std::uint64_t{0});
  put(end.number(mcap::checksum(end.bytes())).raw(mcap::magic).bytes());
}

void McapWriter::put(const Bytes& bytes) {
  write_(bytes);
  place_ += bytes.size();
}

}  // namespace seqloop::bags
