// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace seqloop::bags {

/// Writes an MCAP file of one topic as ROS 2 does: chunks without compression, indexed, with check
/// sums. Everything goes out in order; nothing is written twice.
class McapWriter {
 public:
  using Write = std::function<void(std::span<const std::uint8_t>)>;

  struct Topic {
    std::string_view name;
    std::string_view type;        ///< `seqloop_msgs/msg/LoopClosure`
    std::string_view definition;  ///< of the type, and of all that it is made of
  };

  /// Begins the file. @param write takes the bytes; what it throws passes through every call
  McapWriter(Write write, const Topic& topic);

  /// @param time_ns since 1970   @param message CDR
  void add(std::int64_t time_ns, std::span<const std::uint8_t> message);

  /// The end of the file. The last call.
  void finish();

 private:
  using Bytes = std::vector<std::uint8_t>;

  struct Chunk {
    Bytes records;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  // time and place of each message
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t last = 0;
  };

  void end_chunk();
  void put(const Bytes& bytes);

  Write write_;
  Bytes definitions_;  // schema and channel, which stand in the summary once more
  Bytes chunk_indexes_;
  Chunk chunk_;
  std::uint64_t place_ = 0;  // bytes written so far
  std::uint64_t messages_ = 0;
  std::uint32_t chunks_ = 0;
  std::uint64_t first_ = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ = 0;
};

}  // namespace seqloop::bags
