// SPDX-License-Identifier: MIT
// Where there is no SQLite.
#include "python/map_files.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::python {

void add_map_files(pybind11::module_& module) {
  for (const char* const name : {"map_info", "check_map", "merge_maps"}) {
    module.def(name, [](const pybind11::args& /*files*/) {
      throw SetupError({"map", "this build keeps none: it was made without SQLite",
                        "install libsqlite3-dev and build again"});
    });
  }
}

}  // namespace seqloop::python
