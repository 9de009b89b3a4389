// SPDX-License-Identifier: MIT
// The part of the package that needs no pictures, and so loads no OpenCV.
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "program/drives/map_builder.hpp"
#include "program/options/flag_names.hpp"
#include "program/options/verb.hpp"
#include "python/bindings.hpp"
#include "python/recordings.hpp"
#include "python/reports.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/files/descriptor_source.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

using Unlocked = py::gil_scoped_release;

/// A map, and what keeps threads apart that use it.
class Map {
 public:
  Map(std::int64_t places, std::int64_t descriptor_size, bool close_loops,
      const py::kwargs& settings)
      : Map(Capacity{static_cast<std::size_t>(std::max<std::int64_t>(places, 0)),
                     static_cast<std::size_t>(std::max<std::int64_t>(descriptor_size, 0))},
            close_loops, settings) {}

  void add_drive(const Array& descriptors) {
    Faults faults;
    if (config_.use == Use::close_loops) {
      faults.push_back({"map", "it is for closing loops: it takes its places from the drive",
                        "leave close_loops out to localise in an earlier drive"});
    }
    std::optional<files::Matrix> drive;
    program::collect(faults,
                     [&] { drive = matrix(descriptors, "descriptors", config_.difference); });
    if (drive && drive->columns != map_.descriptor_size()) {
      faults.push_back({"descriptors",
                        "a row has " + std::to_string(drive->columns) + " values, the map's have " +
                            std::to_string(map_.descriptor_size()),
                        "describe all with the same describer"});
    }
    program::refuse(std::move(faults));
    const Unlocked unlocked;
    const std::scoped_lock lock(mutex_);
    if (map_.size() != 0) {
      throw SetupError({"map", "it holds a drive already", "make a map for each drive"});
    }
    files::DescriptorSource source(std::move(*drive));
    program::Progress silent;
    program::fill_map(map_, source, nullptr, config_, silent);
  }

  [[nodiscard]] std::size_t size() {
    const Unlocked unlocked;
    const std::scoped_lock lock(mutex_);
    return map_.size();
  }

  [[nodiscard]] const MatcherConfig& config() const noexcept { return config_; }
  [[nodiscard]] PlaceMap& places() noexcept { return map_; }
  [[nodiscard]] std::mutex& mutex() noexcept { return mutex_; }

  /// To be called by a detector, with the lock. One that closes loops shares its map with none.
  void claim() {
    if (config_.use != Use::close_loops) return;
    if (claimed_) {
      throw SetupError({"map", "another detector adds its drive to it", "make another map"});
    }
    claimed_ = true;
  }

 private:
  Map(const Capacity& capacity, bool close_loops, const py::kwargs& settings)
      : config_(checked(capacity, close_loops, settings)), map_(config_, capacity) {}

  static MatcherConfig checked(const Capacity& capacity, bool close_loops,
                               const py::kwargs& settings) {
    Faults faults;
    const MatcherConfig config =
        config_of(close_loops ? Use::close_loops : Use::localise, settings, faults);
    for (Fault& fault : validate(capacity, config)) {
      faults.push_back(program::in_flags(std::move(fault)));
    }
    program::refuse(std::move(faults));
    return config;
  }

  std::mutex mutex_;
  MatcherConfig config_;
  PlaceMap map_;
  bool claimed_ = false;
};

class Stepper {
 public:
  explicit Stepper(Map& map) : map_(&map) {
    const Unlocked unlocked;
    const std::scoped_lock lock(map.mutex());
    map.claim();
    detector_.emplace(map.config(), map.places());
  }

  Report step(const std::optional<Array>& descriptor) {
    std::span<const float> values;
    if (descriptor) values = python::descriptor(*descriptor, map_->places().descriptor_size());
    const Unlocked unlocked;
    const std::scoped_lock lock(guard());
    if (map_->config().difference == Difference::euclidean) check_length(values);
    stepped_ = true;
    const FrameReport report = detector_->step(values);
    return {report, {report.answers.begin(), report.answers.end()}};
  }

  void skip(std::uint64_t frames) {
    const Unlocked unlocked;
    const std::scoped_lock lock(guard());
    detector_->skip(frames);
  }

  std::vector<Answer> finish() {
    const Unlocked unlocked;
    const std::scoped_lock lock(guard());
    const std::span<const Answer> answers = detector_->finish();
    return {answers.begin(), answers.end()};
  }

  /// @return [places]; NaN where nothing was computed
  py::array_t<float> newest_column() {
    std::vector<float> column;
    {
      const Unlocked unlocked;
      const std::scoped_lock lock(guard());
      if (!stepped_) throw SetupError({"newest_column", "there was no step yet", "step first"});
      column.resize(map_->places().size());
      detector_->newest_column(column);
    }
    for (float& difference : column) {
      if (difference < 0.0F) difference = std::numeric_limits<float>::quiet_NaN();
    }
    return as_array(column, {static_cast<py::ssize_t>(column.size())});
  }

 private:
  /// A detector that closes loops changes its map.
  [[nodiscard]] std::mutex& guard() noexcept {
    return map_->config().use == Use::close_loops ? map_->mutex() : mutex_;
  }

  /// What a detector takes for a frame that could not be read is more likely a mistake here.
  static void check_length(std::span<const float> values) {
    const double squares = squared_norm(values);
    if (!std::isfinite(squares) || squares == 0.0 || std::abs(squares - 1.0) <= 0.01) return;
    throw SetupError({"descriptor",
                      "its length is " + std::to_string(std::sqrt(squares)) + ", not 1",
                      "divide it by numpy.linalg.norm(descriptor)"});
  }

  Map* map_;
  std::mutex mutex_;
  std::optional<Detector> detector_;  // always there
  bool stepped_ = false;
};

}  // namespace
}  // namespace seqloop::python

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using seqloop::python::Map;
  using seqloop::python::Stepper;
  // What the stub says in types is not said again in docstrings.
  py::options options;
  options.disable_function_signatures();
  module.doc() = "Matching, without pictures. Use it through the package seqloop.";
  const auto error = py::module_::import("seqloop._errors").attr("SetupError");
  seqloop::python::translate_faults(error);
  seqloop::python::add_reports(module);

  py::class_<Map>(module, "PlaceMap",
                  "The places of a drive. Room for all of them is taken here, once.\n\n"
                  "max_places: most that it can hold; descriptor_size: D, values in a descriptor.\n"
                  "close_loops: False: add an earlier drive, and localise in it. True: it begins\n"
                  "empty and takes its places from the drive that the detector steps through.\n"
                  "settings: as seqloop.settings() lists them.\n"
                  "Errors: SetupError, a ValueError with every fault at once.")
      .def(py::init<std::int64_t, std::int64_t, bool, const py::kwargs&>(), py::arg("max_places"),
           py::arg("descriptor_size"), py::arg("close_loops") = false)
      .def("add_drive", &Map::add_drive, py::arg("descriptors"),
           "Takes in the drive to localise in, whole: descriptors [N, D], floating point.\n\n"
           "Rows are brought to unit length; a blank row, all zeros, shows what the one before\n"
           "it showed. A map holds one drive. Errors: SetupError.")
      .def("__len__", &Map::size)
      .def_property_readonly(
          "capacity", [](Map& map) { return map.places().capacity(); }, "Most places.")
      .def_property_readonly(
          "descriptor_size", [](Map& map) { return map.places().descriptor_size(); },
          "D, values in a descriptor.");

  py::class_<Stepper>(module, "Detector",
                      "Answers, frame by frame, whether the robot has been here before.\n\n"
                      "map: keeps it alive. To localise: filled; several detectors may share it,\n"
                      "one a thread. To close loops: empty, and this detector's alone.\n"
                      "Errors: SetupError.")
      .def(py::init<Map&>(), py::arg("map"), py::keep_alive<1, 2>())
      .def("step", &Stepper::step, py::arg("descriptor").none(true),
           "Takes the next frame, and answers each frame whose answer is due.\n\n"
           "descriptor: float32 [D] in C order, of unit length; read where it lies, without a\n"
           "copy and without the interpreter's lock. None: the frame could not be read. NaN,\n"
           "infinity and zeros count as such a frame, too.\n"
           "Errors: SetupError for another shape, type or length; then nothing has changed.")
      .def("skip", &Stepper::skip, py::arg("frames"),
           "Takes note of frames that never came: the camera lost them, or they were dropped.")
      .def("finish", &Stepper::finish,
           "The recording is over: answers every frame that still waits.")
      .def("newest_column", &Stepper::newest_column,
           "The newest frame's column of the difference matrix, float32 [N]: NaN where nothing\n"
           "was computed, which is nearly everywhere unless all rows are candidates\n"
           "(method=\"seqcnnslam\"). Errors: SetupError before the first step.");

  seqloop::python::add_recordings(module);
}
