// SPDX-License-Identifier: MIT
#include "program/options/loop_options.hpp"

#include <chrono>
#include <stdexcept>

namespace seqloop::program {
namespace {

constexpr double shortest_ms = 1e-6;  // a nanosecond
constexpr double longest_ms = 1e9;

Nanoseconds limit(double ms, const char* name, bool must_be, Faults& faults) {
  const bool fits = ms <= longest_ms && (ms >= shortest_ms || (ms == 0.0 && !must_be));
  if (!fits) {
    faults.push_back({std::string("budget-") + name,
                      must_be ? "it must be 1e-6 to 1e9 milliseconds"
                              : "it must be 0 (no limit), or 1e-6 to 1e9 milliseconds"});
    return {};
  }
  return std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double, std::milli>(ms));
}

std::uint32_t count(std::size_t value, std::uint32_t least, const char* name, Faults& faults) {
  constexpr std::size_t most = 1'000'000;
  if (value < least || value > most) {
    faults.push_back({std::string("overload-") + name,
                      "it must be " + std::to_string(least) + " to " + std::to_string(most)});
    return least;
  }
  return static_cast<std::uint32_t>(value);
}

OverloadPolicy parse_policy(std::string_view text) {
  for (const OverloadPolicy policy : {OverloadPolicy::drop_oldest, OverloadPolicy::every_nth}) {
    if (text == name(policy)) return policy;
  }
  throw std::invalid_argument("'" + std::string(text) + "' is neither drop-oldest nor every-nth");
}

}  // namespace

std::string_view name(OverloadPolicy policy) noexcept {
  return policy == OverloadPolicy::every_nth ? "every-nth" : "drop-oldest";
}

void add_loop_options(OptionTable& options, LoopSettings& settings) {
  options.section("Budget");
  options.number("budget-total", settings.total_ms,
                 "milliseconds that grab, describe and match may take together [40]");
  options.section("Budget", Shown::in_help_all);
  options.number("budget-age", settings.age_ms,
                 "how old a live picture may be when it is taken up, in milliseconds [0: any]");
  options.number("budget-grab", settings.grab_ms, "milliseconds for reading and decoding [0: any]");
  options.number("budget-describe", settings.describe_ms, "milliseconds for describing [0: any]");
  options.number("budget-match", settings.match_ms, "milliseconds for matching [0: any]");
  options.add({"overload-policy", ValueKind::text,
               "while a live loop misses its budget: drop-oldest, always on with the newest frame; "
               "every-nth, only every n-th frame [drop-oldest]",
               [&settings](std::string_view value) { settings.policy = parse_policy(value); }});
  options.count("overload-every", settings.every, "n of every-nth [2]");
  options.count("overload-after", settings.after,
                "misses in a row from which on a loop is overloaded [5]");
  options.count("overload-recover", settings.recover,
                "frames in a row within the budget after which it is not any more [50]");
}

Budget budget(const LoopSettings& settings, Faults& faults) {
  return {limit(settings.total_ms, "total", true, faults),
          limit(settings.age_ms, "age", false, faults),
          limit(settings.grab_ms, "grab", false, faults),
          limit(settings.describe_ms, "describe", false, faults),
          limit(settings.match_ms, "match", false, faults)};
}

OverloadRule overload_rule(const LoopSettings& settings, Faults& faults) {
  if (settings.policy != OverloadPolicy::every_nth && settings.every != LoopSettings{}.every) {
    faults.push_back({"overload-every", "the newest frame is taken, not every n-th",
                      "--overload-policy every-nth, or leave it out"});
  }
  return {settings.policy, count(settings.every, 2, "every", faults),
          count(settings.after, 1, "after", faults), count(settings.recover, 1, "recover", faults)};
}

}  // namespace seqloop::program
