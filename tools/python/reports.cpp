// SPDX-License-Identifier: MIT
#include "python/reports.hpp"

#include <pybind11/stl.h>

#include <initializer_list>
#include <string>

namespace seqloop::python {
namespace {

namespace py = pybind11;

template <class Owner>
std::string shown(const Owner& owner, std::initializer_list<const char*> names) {
  std::string text;
  const py::object self = py::cast(owner);
  for (const char* const each : names) {
    text += (text.empty() ? "" : ", ") + std::string(each) + "=" +
            py::repr(self.attr(each)).template cast<std::string>();
  }
  return "(" + text + ")";
}

}  // namespace

void add_reports(py::module_& module) {
  py::class_<Match>(module, "Match", "The best place for a frame.")
      .def_readonly("place", &Match::place)
      .def_readonly("score", &Match::score)
      .def_readonly("uniqueness", &Match::uniqueness)
      .def_readonly("velocity", &Match::velocity)
      .def_readonly("head", &Match::head)
      .def_readonly("runner_up", &Match::runner_up)
      .def_readonly("stood", &Match::stood)
      .def_property_readonly("frame", &Match::frame)
      .def("__repr__", [](const Match& match) {
        return "Match" + shown(match, {"place", "score", "uniqueness", "velocity", "head",
                                       "runner_up", "stood"});
      });
  py::class_<Answer>(module, "Answer", "What is said of one frame in the end.")
      .def_readonly("frame", &Answer::frame)
      .def_property_readonly("gate", [](const Answer& answer) { return name(answer.gate); })
      .def_readonly("probability", &Answer::probability)
      .def_readonly("match", &Answer::match)
      .def("__repr__", [](const Answer& answer) {
        return "Answer" + shown(answer, {"frame", "gate", "probability", "match"});
      });
  py::class_<Belief>(module, "Belief", "Where the robot is believed to be at the newest frame.")
      .def_readonly("place", &Belief::place)
      .def_readonly("probability", &Belief::probability)
      .def_readonly("new_place", &Belief::new_place)
      .def_readonly("stood", &Belief::stood)
      .def_property_readonly("frame", &Belief::frame)
      .def("__repr__", [](const Belief& belief) {
        return "Belief" + shown(belief, {"place", "probability", "new_place", "stood"});
      });
  py::class_<Work>(module, "Work", "What a frame cost; the same on every machine.")
      .def_readonly("candidates", &Work::candidates)
      .def_readonly("distances", &Work::distances)
      .def_readonly("line_sums", &Work::line_sums)
      .def_readonly("scanned", &Work::scanned)
      .def_readonly("sketches", &Work::sketches);
  const auto of = [](auto member) {
    return [member](const Report& report) { return report.report.*member; };
  };
  py::class_<Report>(module, "Report", "What one step has to say.")
      .def_readonly("answers", &Report::answers)
      .def_property_readonly("now", of(&FrameReport::now))
      .def_property_readonly("newest", of(&FrameReport::newest))
      .def_property_readonly("frame", of(&FrameReport::frame))
      .def_property_readonly("gate", [](const Report& report) { return name(report.report.gate); })
      .def_property_readonly("match", of(&FrameReport::match))
      .def_property_readonly("k", of(&FrameReport::k))
      .def_property_readonly("full_search", of(&FrameReport::full_search))
      .def_property_readonly("map_full", of(&FrameReport::map_full))
      .def_property_readonly("work", of(&FrameReport::work))
      .def("__repr__", [](const Report& report) {
        return "Report" + shown(report, {"newest", "gate", "answers", "now"});
      });
}

}  // namespace seqloop::python
