// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "seqloop/fault.hpp"

namespace seqloop::program {

/// Parts of a work of which each is tried, whatever became of the others; what failed is told at
/// the end.
class Attempts {
 public:
  /// @return whether the part was done
  template <class Part>
  bool operator()(Part part) {
    try {
      part();
      return true;
    } catch (const SetupError& error) {
      faults_.insert(faults_.end(), error.faults().begin(), error.faults().end());
    } catch (const std::bad_alloc&) {
      fail("memory: there is not enough");
    } catch (const std::exception& error) {
      fail(error.what());
    }
    return false;
  }

  /// Something has failed that throws nothing. @param why a line
  void fail(std::string why) { failures_.push_back(std::move(why)); }
  void fail(Fault fault) { faults_.push_back(std::move(fault)); }

  /// Throws what has failed: SetupError where all of it is, or the last failure, with the others
  /// said before.
  void end() const;

 private:
  Faults faults_;
  std::vector<std::string> failures_;
};

}  // namespace seqloop::program
