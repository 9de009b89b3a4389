// SPDX-License-Identifier: MIT
#include "bags/mcap_bag.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "bags/byte_source.hpp"
#include "bags/decompress.hpp"
#include "bags/mcap_records.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::bags {
namespace {

using mcap::Bytes;
using mcap::Opcode;

constexpr std::uint64_t most_summary_bytes = std::uint64_t{1} << 28U;

std::int64_t nanoseconds(std::uint64_t time) {
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return static_cast<std::int64_t>(std::min(time, most));
}

/// What a summary or a file says of its channels.
class Contents {
 public:
  void add(const mcap::Record& record) {
    if (record.opcode == Opcode::schema) {
      if (auto schema = mcap::read_schema(record.content))
        schemas_.emplace(schema->id, std::move(schema->name));
    } else if (record.opcode == Opcode::channel) {
      if (auto channel = mcap::read_channel(record.content)) {
        const std::uint16_t id = channel->id;
        channels_.emplace(id, std::move(*channel));
      }
    }
  }

  void count(std::uint16_t channel, std::uint64_t messages) { messages_[channel] += messages; }

  /// @return topics by name: a topic may have several channels
  [[nodiscard]] std::vector<Topic> topics() const {
    std::map<std::string, Topic> topics;
    for (const auto& [id, channel] : channels_) {
      const auto schema = schemas_.find(channel.schema);
      Topic& topic =
          topics
              .try_emplace(channel.topic,
                           Topic{channel.topic, schema == schemas_.end() ? "" : schema->second,
                                 channel.encoding, 0})
              .first->second;
      const auto messages = messages_.find(id);
      if (messages != messages_.end()) topic.messages += messages->second;
    }
    std::vector<Topic> list;
    list.reserve(topics.size());
    for (auto& [name, topic] : topics) list.push_back(std::move(topic));
    return list;
  }

  [[nodiscard]] std::set<std::uint16_t> channels_of(std::string_view topic) const {
    std::set<std::uint16_t> ids;
    for (const auto& [id, channel] : channels_)
      if (channel.topic == topic) ids.insert(id);
    return ids;
  }

  /// A summary need neither repeat schemas and channels nor count each channel's messages.
  [[nodiscard]] bool whole(const mcap::Statistics& statistics) const {
    std::uint64_t counted = 0;
    for (const auto& [id, messages] : messages_) counted += messages;
    const bool typed = std::ranges::all_of(channels_, [&](const auto& channel) {
      return channel.second.schema == 0 || schemas_.contains(channel.second.schema);
    });
    return typed && !channels_.empty() && channels_.size() >= statistics.channels &&
           schemas_.size() >= statistics.schemas && counted >= statistics.all_messages;
  }

 private:
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, mcap::Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> messages_;
};

/// The records of a file that are of interest here, those in chunks too, from its first to its
/// last.
class Walk {
 public:
  explicit Walk(ByteSource& bytes) noexcept : bytes_(&bytes) {}

  /// @param skipped places of chunks that are left out
  void begin(std::set<std::uint64_t> skipped) {
    skipped_ = std::move(skipped);
    place_ = mcap::magic.size();
    chunk_ = {};
    chunk_fault_ = {};
  }

  /// @param record  a schema, a channel or a message, valid until the next call
  /// @param fault   of what is damaged
  [[nodiscard]] Read next(mcap::Record& record, std::string_view& fault) {
    while (true) {
      if (!chunk_.empty()) {
        if (const auto found = mcap::take_record(chunk_)) {
          record = *found;
          return Read::message;
        }
        chunk_ = {};
        if (chunk_fault_.empty() && place_ < bytes_->size())
          chunk_fault_ = "a record in a chunk is longer than the chunk";
      }
      if (!chunk_fault_.empty()) {
        fault = std::exchange(chunk_fault_, {});
        return Read::damaged;
      }
      if (!take_from_file(record)) return Read::end;
      if (!record.content.empty()) return Read::message;
    }
  }

  /// Why the walk ended where it should not have; empty where it did not.
  [[nodiscard]] const std::string& ended_early() const noexcept { return ended_early_; }

 private:
  /// @param record emptied where there is none to hand over
  /// @return false at the end
  bool take_from_file(mcap::Record& record) {
    record = {};
    std::array<std::uint8_t, mcap::head_bytes> head{};
    if (!bytes_->read(place_, head)) return end("it is cut off");
    mcap::Cursor cursor(head);
    const auto opcode = static_cast<Opcode>(cursor.number<std::uint8_t>());
    const auto length = cursor.number<std::uint64_t>();
    const std::uint64_t content = place_ + head.size();
    const std::uint64_t there = std::min(length, bytes_->size() - content);
    if (opcode == Opcode::data_end || opcode == Opcode::footer) return false;
    if (opcode == Opcode::none) return end("no record begins there");
    const bool skips = skipped_.contains(place_);
    const std::uint64_t start = std::exchange(place_, content + there);
    if (opcode == Opcode::chunk && !skips) {
      open_chunk(content, there, there == length);
    } else if (there < length) {
      place_ = start;
      return end("it is cut off");
    } else if (opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::message) {
      if (length > most_bytes) {
        chunk_fault_ = "a message has more than 1 GiB";
      } else if (fetch(content, length)) {
        record = {opcode, packed_};
      } else {
        return end("it cannot be read");
      }
    }
    return true;
  }

  /// @param whole otherwise the file ends within it
  void open_chunk(std::uint64_t place, std::uint64_t length, bool whole) {
    if (length > most_bytes) {
      chunk_fault_ = "a chunk has more than 1 GiB";
      return;
    }
    if (!whole) static_cast<void>(end("it is cut off"));
    if (!fetch(place, length)) {
      chunk_fault_ = "a chunk cannot be read";
      return;
    }
    const auto head = mcap::read_chunk(packed_);
    if (!head) {
      if (whole) chunk_fault_ = "a chunk is shorter than its own head";
      return;
    }
    Bytes packed = Bytes(packed_).subspan(head->bytes);
    packed = packed.first(
        static_cast<std::size_t>(std::min<std::uint64_t>(packed.size(), head->packed)));
    const Decompressed unpacked = decompress(head->compression, packed, head->size, unpacked_);
    chunk_ = unpacked.bytes;
    if (whole) chunk_fault_ = unpacked.fault;
    if (!unpacked.fault.empty() || head->crc == 0) return;
    if (mcap::checksum(chunk_) == head->crc) return;
    chunk_ = {};
    chunk_fault_ = "the check sum of a chunk is wrong";
  }

  bool fetch(std::uint64_t place, std::uint64_t length) {
    packed_.resize(static_cast<std::size_t>(length));
    return bytes_->read(place, packed_);
  }

  bool end(const char* why) {
    ended_early_ = "the file ends early: " + std::string(why) + " at byte " +
                   std::to_string(place_) + " of " + std::to_string(bytes_->size());
    return false;
  }

  ByteSource* bytes_;
  std::set<std::uint64_t> skipped_;
  std::uint64_t place_ = 0;  // of the next record in the file
  std::vector<std::uint8_t> packed_;
  std::vector<std::uint8_t> unpacked_;
  Bytes chunk_;  // what is left of it
  std::string_view chunk_fault_;
  std::string ended_early_;
};

class McapBag : public Bag {
 public:
  McapBag(std::unique_ptr<ByteSource> bytes, const std::string& name)
      : bytes_(std::move(bytes)), walk_(*bytes_) {
    std::array<std::uint8_t, mcap::magic.size()> start{};
    if (!bytes_->read(0, start) || start != mcap::magic)
      throw SetupError(Fault{name, "is not an MCAP file", "check the name"});
    facts_.format = "MCAP";
    if (!read_summary()) scan();
    facts_.topics = contents_.topics();
    walk_.begin({});
  }

  [[nodiscard]] const BagFacts& facts() const noexcept override { return facts_; }

  void choose(std::string_view topic) override {
    chosen_ = contents_.channels_of(topic);
    std::set<std::uint64_t> skipped;
    for (const mcap::ChunkIndex& chunk : chunks_) {
      const auto wanted = [&](std::uint16_t channel) { return chosen_.contains(channel); };
      if (!chunk.channels.empty() && std::ranges::none_of(chunk.channels, wanted))
        skipped.insert(chunk.start);
    }
    walk_.begin(std::move(skipped));
  }

  [[nodiscard]] Read next(Message& message) override {
    message = {};
    mcap::Record record;
    while (true) {
      const Read read = walk_.next(record, message.fault);
      if (read != Read::message) return read;
      if (record.opcode != Opcode::message) continue;
      const auto head = mcap::read_message(record.content);
      if (!head) {
        message.fault = "a message is shorter than its own head";
        return Read::damaged;
      }
      if (!chosen_.contains(head->channel)) continue;
      message.time_ns = nanoseconds(head->log_time);
      message.bytes = head->data;
      return Read::message;
    }
  }

  [[nodiscard]] std::vector<std::string> notes() const override {
    std::vector<std::string> lines = notes_;
    if (!walk_.ended_early().empty()) lines.push_back(walk_.ended_early());
    return lines;
  }

 private:
  /// @return false where there is none, or not enough of one
  bool read_summary() {
    constexpr std::uint64_t tail = mcap::head_bytes + mcap::footer_bytes + mcap::magic.size();
    if (bytes_->size() < mcap::magic.size() + tail) return false;
    std::array<std::uint8_t, tail> end{};
    const std::uint64_t footer = bytes_->size() - tail;
    if (!bytes_->read(footer, end)) return false;
    if (!std::equal(mcap::magic.begin(), mcap::magic.end(), end.end() - mcap::magic.size()))
      return false;
    Bytes rest(end);
    const auto record = mcap::take_record(rest);
    if (!record || record->opcode != Opcode::footer) return false;
    mcap::Cursor cursor(record->content);
    const auto start = cursor.number<std::uint64_t>();
    static_cast<void>(cursor.number<std::uint64_t>());  // place of the summary's own index
    const auto sum = cursor.number<std::uint32_t>();
    if (start == 0 || start > footer || footer - start > most_summary_bytes) return false;
    std::vector<std::uint8_t> summary(static_cast<std::size_t>(footer - start));
    if (!bytes_->read(start, summary)) return false;
    const Bytes summed = Bytes(end).first(mcap::head_bytes + mcap::footer_bytes - sizeof sum);
    if (sum == 0 || mcap::checksum(summed, mcap::checksum(summary)) == sum)
      return take_summary(summary);
    notes_.emplace_back("the check sum of the summary is wrong: it is not used");
    return false;
  }

  bool take_summary(Bytes summary) {
    Contents contents;
    std::vector<mcap::ChunkIndex> chunks;
    std::optional<mcap::Statistics> statistics;
    while (const auto record = mcap::take_record(summary)) {
      contents.add(*record);
      if (record->opcode == Opcode::chunk_index) {
        auto chunk = mcap::read_chunk_index(record->content);
        if (!chunk) return false;
        chunks.push_back(std::move(*chunk));
      } else if (record->opcode == Opcode::statistics) {
        statistics = mcap::read_statistics(record->content);
        if (!statistics) return false;
        facts_.start_ns = nanoseconds(statistics->start);
        facts_.end_ns = nanoseconds(statistics->end);
        for (const auto& [channel, messages] : statistics->messages)
          contents.count(channel, messages);
      }
    }
    if (!statistics || !contents.whole(*statistics)) return false;
    contents_ = std::move(contents);
    chunks_ = std::move(chunks);
    return true;
  }

  /// Looks at everything once: what has no full summary tells its topics nowhere else.
  void scan() {
    notes_.emplace_back("the file has no full summary: all of it was read to find its topics");
    facts_.start_ns = std::numeric_limits<std::int64_t>::max();
    facts_.end_ns = 0;
    walk_.begin({});
    mcap::Record record;
    std::string_view fault;
    for (Read read = walk_.next(record, fault); read != Read::end;
         read = walk_.next(record, fault)) {
      if (read == Read::damaged) continue;
      contents_.add(record);
      if (record.opcode != Opcode::message) continue;
      const auto head = mcap::read_message(record.content);
      if (!head) continue;
      contents_.count(head->channel, 1);
      facts_.start_ns = std::min(facts_.start_ns, nanoseconds(head->log_time));
      facts_.end_ns = std::max(facts_.end_ns, nanoseconds(head->log_time));
    }
    facts_.start_ns = std::min(facts_.start_ns, facts_.end_ns);
  }

  std::unique_ptr<ByteSource> bytes_;
  Walk walk_;
  BagFacts facts_;
  Contents contents_;
  std::vector<mcap::ChunkIndex> chunks_;
  std::set<std::uint16_t> chosen_;
  std::vector<std::string> notes_;
};

}  // namespace

std::unique_ptr<Bag> open_mcap(std::unique_ptr<ByteSource> bytes, const std::string& name) {
  return std::make_unique<McapBag>(std::move(bytes), name);
}

}  // namespace seqloop::bags
