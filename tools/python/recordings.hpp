// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#include "python/bindings.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::python {

/// A copy of an array of descriptors, of unit length where Euclid compares, as the program reads
/// it. @param name for messages
/// Throws SetupError: it is no [N, D] of finite floating-point numbers.
[[nodiscard]] files::Matrix matrix(const Array& array, const std::string& name,
                                   Difference difference);

/// What the settings say of a map of that many places; adds what is wrong with them.
[[nodiscard]] MatcherConfig config_of(Use use, std::size_t places, const pybind11::kwargs& settings,
                                      Faults& faults);

/// match, evaluate, settings: of whole drives.
void add_recordings(pybind11::module_& module);

}  // namespace seqloop::python
