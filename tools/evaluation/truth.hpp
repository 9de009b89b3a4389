#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "evaluation/csv.hpp"

namespace seqloop::evaluation {

/// Which places each query frame really shows. A frame without a place is not in it.
class Truth {
 public:
  /// Frame i shows place i, for i in [0, frames).
  static Truth identity(std::uint64_t frames);

  /// Rows `query,reference`; several rows of one query are several right answers.
  /// Throws SetupError as CsvTable does, and without rows.
  static Truth from_csv(const CsvTable& table);

  /// Frames that have a place.
  [[nodiscard]] std::uint64_t frames() const noexcept {
    return identity_frames_.value_or(places_.size());
  }

  /// @param tolerance frames
  [[nodiscard]] bool right(std::uint64_t query, std::uint64_t match,
                           std::uint64_t tolerance) const noexcept;

 private:
  std::optional<std::uint64_t> identity_frames_;  // set: frame i shows place i
  std::map<std::uint64_t, std::vector<std::uint64_t>> places_;
};

}  // namespace seqloop::evaluation
