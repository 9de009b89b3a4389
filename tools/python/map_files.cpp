// SPDX-License-Identifier: MIT
#include "python/map_files.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <vector>

#include "program/map/merge.hpp"
#include "python/bindings.hpp"
#include "python/interpreter_lock.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

using File = Argument<std::filesystem::path, "file">;

py::dict info(const File& given) {
  const std::filesystem::path& file = given;
  const sqlite::MapFile map = sqlite::MapFile::read_only(file);
  const sqlite::MapForm& form = map.form();
  using namespace py::literals;
  py::list sessions;
  for (const sqlite::SessionFacts& session : map.sessions()) {
    sessions.append(py::dict("name"_a = readable(session.name), "places"_a = session.places,
                             "frames"_a = session.frames, "began_ns"_a = session.began_ns,
                             "settings"_a = readable(session.settings)));
  }
  return py::dict("descriptor_size"_a = form.descriptor_size, "form"_a = readable(form.form),
                  "describer"_a = readable(form.describer), "sessions"_a = sessions);
}

py::list check(const File& file) {
  const std::vector<std::string> found = [&] {
    const Unlocked unlocked;
    return sqlite::MapFile::read_only(file).check();
  }();
  py::list wrong;
  for (const std::string& what : found) wrong.append(readable(what));
  return wrong;
}

std::vector<std::uint64_t> merge(const Argument<std::vector<std::filesystem::path>, "maps">& maps,
                                 const Argument<std::filesystem::path, "out">& given) {
  const std::filesystem::path& out = given;
  if (out.empty()) throw SetupError({"out", "its name is empty", "name a file"});
  const Unlocked unlocked;
  return program::merge_maps(maps, out, look_for_interruption);
}

}  // namespace

void add_map_files(py::module_& module) {
  // What was in the file stays as it was: a disk is full, or gone.
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const sqlite::SaveError& error) {
      set_os_error(error.what());
    }
  });
  module.def("map_info", &info, py::arg("file"));
  module.def("check_map", &check, py::arg("file"));
  module.def("merge_maps", &merge, py::arg("maps"), py::arg("out"));
}

}  // namespace seqloop::python
