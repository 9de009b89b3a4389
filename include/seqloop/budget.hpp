// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "seqloop/pipeline.hpp"

namespace seqloop {

/// What a frame may take, in all and stage by stage. Zero: no limit.
struct Budget {
  Nanoseconds total = std::chrono::milliseconds(40);  ///< grab, describe and match
  Nanoseconds age{0};  ///< of the picture when it is taken up, which is the camera's part
  Nanoseconds grab{0};
  Nanoseconds describe{0};
  Nanoseconds match{0};
};

/// Which limits a frame broke.
struct Misses {
  bool total = false;
  bool age = false;
  bool grab = false;
  bool describe = false;
  bool match = false;

  [[nodiscard]] bool any() const noexcept { return total || age || grab || describe || match; }
};

[[nodiscard]] Misses misses(const StageTimes& times, const Budget& budget) noexcept;

/// What a live loop does while its budget is exceeded.
enum class OverloadPolicy : std::uint8_t {
  drop_oldest,  ///< takes up the newest frame whenever it is done with one; others are dropped
  every_nth     ///< takes up every n-th frame only, so that gaps are even
};

/// When a loop is overloaded, and what it does then. Numbers below their least count as that.
struct OverloadRule {
  OverloadPolicy policy = OverloadPolicy::drop_oldest;
  std::uint32_t every = 2;     ///< n of `every_nth`, at least 2
  std::uint32_t after = 5;     ///< frames in a row over the budget that begin it, at least 1
  std::uint32_t recover = 50;  ///< frames in a row within the budget that end it, at least 1
};

/// Tells a loop that is overloaded from one that is late now and then.
class OverloadWatch {
 public:
  explicit OverloadWatch(const OverloadRule& rule) noexcept
      : rule_{rule.policy, std::max<std::uint32_t>(rule.every, 2),
              std::max<std::uint32_t>(rule.after, 1), std::max<std::uint32_t>(rule.recover, 1)} {}

  /// @param missed whether the frame broke its budget
  /// @return whether this began or ended an overload. Allocates: never.
  bool observe(bool missed) noexcept;

  [[nodiscard]] bool overloaded() const noexcept { return overloaded_; }
  [[nodiscard]] std::uint64_t episodes() const noexcept { return episodes_; }

  /// Of how many frames one is to be taken up now.
  [[nodiscard]] std::uint32_t take_every() const noexcept {
    return overloaded_ && rule_.policy == OverloadPolicy::every_nth ? rule_.every : 1;
  }

 private:
  OverloadRule rule_;
  bool overloaded_ = false;
  std::uint32_t in_a_row_ = 0;  // frames that speak for the other state
  std::uint64_t episodes_ = 0;
};

}  // namespace seqloop
