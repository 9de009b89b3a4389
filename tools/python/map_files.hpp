// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

namespace seqloop::python {

/// map_info, check_map, merge_maps: of maps in files that nobody steps through.
void add_map_files(pybind11::module_& module);

}  // namespace seqloop::python
