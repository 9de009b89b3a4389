// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "program/options/options.hpp"
#include "seqloop/budget.hpp"

namespace seqloop::program {

/// Limits of a loop and what it does when it breaks them, as a user writes them.
struct LoopSettings {
  double total_ms = 40.0;
  double age_ms = 0.0;
  double grab_ms = 0.0;
  double describe_ms = 0.0;
  double match_ms = 0.0;
  OverloadPolicy policy = OverloadPolicy::drop_oldest;
  std::size_t every = 2;
  std::size_t after = 5;
  std::size_t recover = 50;
};

/// Flags `--budget-…` and `--overload-…`. @param settings lives as long as the table
void add_loop_options(OptionTable& options, LoopSettings& settings);

/// Adds a fault for each limit that is out of its range.
[[nodiscard]] Budget budget(const LoopSettings& settings, Faults& faults);
[[nodiscard]] OverloadRule overload_rule(const LoopSettings& settings, Faults& faults);

/// `drop-oldest`, `every-nth`.
[[nodiscard]] std::string_view name(OverloadPolicy policy) noexcept;

}  // namespace seqloop::program
