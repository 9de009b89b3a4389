// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {

/// What is wrong with the lines of a file: a handful of faults is told, and how many more there
/// are.
class LineFaults {
 public:
  /// @param name the file, for messages
  explicit LineFaults(std::string name) : name_(std::move(name)) {}

  void add(Fault fault) {
    constexpr std::size_t handful = 5;
    if (faults_.size() < handful) {
      faults_.push_back(std::move(fault));
    } else {
      ++more_;
    }
  }

  /// Takes what a part finds wrong.
  template <class Part>
  void collect(Part part) {
    try {
      part();
    } catch (const SetupError& error) {
      for (const Fault& fault : error.faults()) add(fault);
    }
  }

  /// Throws SetupError, where anything is wrong.
  void refuse() {
    if (more_ > 0) faults_.push_back({name_, "and " + std::to_string(more_) + " more like these"});
    if (!faults_.empty()) throw SetupError(std::move(faults_));
  }

 private:
  std::string name_;
  Faults faults_;
  std::size_t more_ = 0;
};

}  // namespace seqloop::evaluation
