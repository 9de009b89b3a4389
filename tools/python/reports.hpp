// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "seqloop/frame_report.hpp"

namespace seqloop::python {

/// A FrameReport whose answers stay: they are in `kept`.
struct Report : FrameReport {
  std::vector<Answer> kept;
};

/// Report, Answer, Match, Belief, Work.
void add_reports(pybind11::module_& module);

}  // namespace seqloop::python
