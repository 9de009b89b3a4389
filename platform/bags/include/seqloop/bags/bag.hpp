// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seqloop::bags {

/// A topic of a bag.
struct Topic {
  std::string name;            ///< `/camera/image_raw`
  std::string type;            ///< `sensor_msgs/msg/Image`
  std::string encoding;        ///< of its messages; only `cdr` can be read
  std::uint64_t messages = 0;  ///< as the bag says, or as were found
};

/// What a bag holds.
struct BagFacts {
  std::string format;         ///< for people: `MCAP`, `rosbag2 db3`
  std::vector<Topic> topics;  ///< by name
  std::int64_t start_ns = 0;  ///< when the first message was recorded, since 1970
  std::int64_t end_ns = 0;    ///< and the last one
};

struct Message {
  std::int64_t time_ns = 0;             ///< when it was recorded, since 1970
  std::span<const std::uint8_t> bytes;  ///< valid until the next call
  std::string_view fault;               ///< of what is damaged: why
};

enum class Read : std::uint8_t {
  message,
  damaged,  ///< a part of the bag cannot be read; what comes after it can
  end
};

/// Port: a recording of topics.
class Bag {
 public:
  Bag() = default;
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;
  Bag(Bag&&) = delete;
  Bag& operator=(Bag&&) = delete;
  virtual ~Bag() = default;

  [[nodiscard]] virtual const BagFacts& facts() const noexcept = 0;

  /// From now on messages of this topic come, from the first one on. Of a topic that is not there,
  /// none do. Throws std::bad_alloc.
  virtual void choose(std::string_view topic) = 0;

  /// @param message overwritten, in the order in which they were recorded
  /// Throws std::bad_alloc. Allocates: a buffer for the largest chunk or message.
  [[nodiscard]] virtual Read next(Message& message) = 0;

  /// What a person should know of the bag so far, one line each.
  [[nodiscard]] virtual std::vector<std::string> notes() const = 0;
};

/// Whether a path means a bag: `.mcap`, `.db3`, or a folder that holds such files.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

/// Opens a bag for reading; nothing is written, not even beside it. Of MCAP files: indexed or not,
/// cut off, chunks uncompressed or of LZ4 or Zstandard. Of db3: every version of the schema. A
/// folder is read file after file, as its metadata.yaml lists them, or without one in natural
/// order. Throws SetupError: not there, not such a file, in need of a library that this build
/// lacks. Work: of an MCAP file without a summary, all of it is read once.
[[nodiscard]] std::unique_ptr<Bag> open_bag(const std::filesystem::path& path);

}  // namespace seqloop::bags
