// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#include "python/bindings.hpp"
#include "seqloop/files/npy_file.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::python {

/// The descriptors that were given. @param name of the argument
/// Throws SetupError: they are no array [N, D] of floating-point numbers.
[[nodiscard]] Array drive_of(const Given& given, const std::string& name);

/// A copy of such an array, of unit length where Euclid compares, as the program reads it.
/// @param name of the argument
/// Throws SetupError: its numbers are not finite.
[[nodiscard]] files::Matrix matrix(const Array& drive, const std::string& name,
                                   Difference difference);

/// What the settings say of a map of that many places; adds what is wrong with them.
[[nodiscard]] MatcherConfig config_of(Use use, std::size_t places, const pybind11::kwargs& settings,
                                      Faults& faults);

/// match, evaluate, settings: of whole drives.
void add_recordings(pybind11::module_& module);

}  // namespace seqloop::python
