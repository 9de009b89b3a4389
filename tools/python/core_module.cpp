// SPDX-License-Identifier: MIT
// The part of the package that needs no pictures, and so loads no OpenCV.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "program/drives/drive_length.hpp"
#include "program/drives/source_numbers.hpp"
#include "program/options/verb.hpp"
#include "python/bindings.hpp"
#include "python/interpreter_lock.hpp"
#include "python/map.hpp"
#include "python/map_files.hpp"
#include "python/recordings.hpp"
#include "python/reports.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/difference.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

// Of a map in a file, where no time is given; as `seqloop match` has it.
constexpr double frames_a_second = 10.0;

// A map in a file has nanoseconds, in 64 bits.
constexpr double most_seconds = 9.2e9;
constexpr auto most_frames = static_cast<std::uint64_t>(most_seconds * frames_a_second);

class Stepper {
 public:
  explicit Stepper(std::shared_ptr<Map> map) : map_(std::move(map)) {
    const Unlocked unlocked;
    const auto lock = map_->lock();
    map_->claim();
    detector_.emplace(map_->config(), map_->places());
    if (map_->config().use == Use::localise && map_->file() == nullptr) check_length();
    // Of a map in a file, places have numbers of their own.
    const bool own_places = map_->config().use == Use::close_loops && map_->file() == nullptr;
    numbers_.emplace(map_->config(), own_places ? &map_->places() : nullptr);
    map_->begin();
  }

  Report step(const std::optional<Given>& descriptor,
              const Argument<std::optional<double>, "time_s">& given) {
    const std::optional<double>& time_s = given;
    std::span<const float> values;
    Faults faults;
    if (descriptor) {
      program::collect(faults, [&] {
        values = python::descriptor(*descriptor, map_->places().descriptor_size());
      });
    }
    if (time_s && !std::isfinite(*time_s)) {
      faults.push_back({"time_s", "it is not finite", "give seconds, or leave it out"});
    } else if (time_s && std::abs(*time_s) > most_seconds) {
      faults.push_back({"time_s", fmt::format("{} s are more than 290 years", *time_s),
                        "give seconds, not nanoseconds"});
    }
    program::refuse(std::move(faults));
    std::optional<std::string> trouble;
    Report report;
    {
      const Unlocked unlocked;
      const auto lock = guard();
      program::LastingMap* const file = kept_on();
      if (map_->config().difference == Difference::euclidean) check_norm(values);
      skip_what_never_came();
      stepped_ = true;
      const std::uint64_t frame = frames_++;
      ProcessedFrame processed{};
      processed.frame.index = frame;
      processed.report = detector_->step(values);
      if (file != nullptr) {
        file->note(*detector_, processed.report.newest, frame,
                   time_s.value_or(static_cast<double>(frame) / frames_a_second), {},
                   processed.report.answers,
                   !values.empty() && !blank(map_->config().difference, values));
        trouble = file->trouble();
      }
      numbers_->rename(processed);
      static_cast<FrameReport&>(report) = processed.report;
      report.kept.assign(report.answers.begin(), report.answers.end());
      report.answers = {};
    }
    if (trouble) warn(*trouble);
    return report;
  }

  void skip(const Argument<std::uint64_t, "frames">& frames) {
    const Unlocked unlocked;
    const auto lock = guard();
    static_cast<void>(kept_on());
    const std::uint64_t count = frames;
    if (count > most_frames || frames_ + count > most_frames) {
      throw SetupError({"frames", fmt::format("{} more are too many to be counted", count),
                        "any number above ds is a gap"});
    }
    frames_ += count;
    never_came_ += count;
  }

  std::vector<Answer> finish() {
    std::vector<Answer> rest;
    std::optional<std::string> unsaved;
    {
      const Unlocked unlocked;
      const auto lock = guard();
      program::LastingMap* const file = kept();
      if (file == nullptr || !rest_) {
        skip_what_never_came();
        const std::span<const Answer> answers = detector_->finish();
        rest_.emplace(answers.begin(), answers.end());
      }
      if (file != nullptr) unsaved = file->finish(*detector_, *rest_);
      const std::span<const Answer> renamed = numbers_->rename(*rest_);
      rest.assign(renamed.begin(), renamed.end());
    }
    if (unsaved) {
      set_os_error(*unsaved);
      throw py::error_already_set();
    }
    return rest;
  }

  /// @return [places]; NaN where nothing was computed
  py::array_t<float> newest_column() {
    std::vector<float> column;
    {
      const Unlocked unlocked;
      const auto lock = guard();
      if (!stepped_) throw SetupError({"newest_column", "there was no step yet", "step first"});
      column.resize(map_->places().size());
      detector_->newest_column(column);
    }
    for (float& difference : column) {
      if (difference < 0.0F) difference = std::numeric_limits<float>::quiet_NaN();
    }
    return as_array(column, {static_cast<py::ssize_t>(column.size())});
  }

  [[nodiscard]] std::string text() { return "Detector(" + map_->text() + ")"; }

 private:
  /// All at once: of a long gap the detector counts none, of a short one each.
  void skip_what_never_came() noexcept { detector_->skip(std::exchange(never_came_, 0)); }

  /// A detector that closes loops changes its map.
  [[nodiscard]] std::unique_lock<std::mutex> guard() {
    return map_->config().use == Use::close_loops ? map_->lock() : std::unique_lock(mutex_);
  }

  /// Of the map: how long the drive will be, nobody knows. Throws SetupError.
  void check_length() const {
    Faults faults;
    const MatcherConfig& config = map_->config();
    program::check_length(faults, config, config.sequence_length + 1, map_->frames());
    program::refuse(std::move(faults));
  }

  /// Where its drive is saved; null: nowhere. A map that is only read is in memory, whole.
  [[nodiscard]] program::LastingMap* kept() {
    return map_->config().use == Use::close_loops ? map_->file() : nullptr;
  }

  /// The same, for frames that are still to come. Throws SetupError: the drive is over.
  [[nodiscard]] program::LastingMap* kept_on() {
    program::LastingMap* const file = kept();
    if (file != nullptr && rest_) {
      throw SetupError({"detector", "its drive is over, and saved", "open the map again"});
    }
    return file;
  }

  /// A report is not lost where warnings are errors.
  static void warn(const std::string& trouble) {
    const auto text = readable(trouble).cast<std::string>();
    if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) PyErr_WriteUnraisable(nullptr);
  }

  /// What a detector takes for a frame that could not be read is more likely a mistake here.
  static void check_norm(std::span<const float> values) {
    const double squares = squared_norm(values);
    if (!std::isfinite(squares) || squares == 0.0 || std::abs(squares - 1.0) <= 0.01) return;
    throw SetupError({"descriptor",
                      "its length is " + std::to_string(std::sqrt(squares)) + ", not 1",
                      "divide it by numpy.linalg.norm(descriptor)"});
  }

  std::shared_ptr<Map> map_;
  std::mutex mutex_;
  std::optional<Detector> detector_;  // always there
  // Likewise. The detector leaves long gaps out.
  std::optional<program::SourceNumbers> numbers_;
  std::uint64_t frames_ = 0;      // that came, or never did
  std::uint64_t never_came_ = 0;  // since the last that did
  bool stepped_ = false;
  std::optional<std::vector<Answer>> rest_;  // once the drive is over
};

/// NumPy 2 has another layout of types than NumPy 1: with a pybind11 that does not know it, arrays
/// would have wrong strides.
void check_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const auto version = py::module_::import("numpy").attr("__version__").cast<std::string>();
  if (version.starts_with("1.")) return;
  throw py::import_error(fmt::format(
      "this is NumPy {}, and seqloop was built with a pybind11 that knows NumPy 1 only: use NumPy "
      "1, or build seqloop with pybind11 2.12 or newer",
      version));
#endif
}

}  // namespace
}  // namespace seqloop::python

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using seqloop::python::Argument;
  using seqloop::python::Map;
  using seqloop::python::outliving;
  using seqloop::python::Stepper;
  module.doc() = "Matching, without pictures. Use it through the package seqloop.";
  module.attr("__version__") = SEQLOOP_VERSION;
  seqloop::python::check_numpy();
  const auto error = py::module_::import("seqloop._errors").attr("SetupError");
  seqloop::python::translate_faults(error);
  seqloop::python::add_reports(module);

  py::class_<Map, std::shared_ptr<Map>>(
      module, "PlaceMap",
      "The places of a drive. Room for all of them is taken here, once.\n\n"
      "max_places: most that it can hold; descriptor_size: D, values in a descriptor.\n"
      "close_loops: False: add an earlier drive, and localise in it. True: it begins\n"
      "empty and takes its places from the drive that the detector steps through.\n"
      "settings: as seqloop.settings() lists them.\n"
      "Errors: SetupError, a ValueError with every fault at once.")
      .def(py::init([](const Argument<std::int64_t, "max_places">& places,
                       const Argument<std::int64_t, "descriptor_size">& size,
                       const Argument<bool, "close_loops">& close_loops,
                       const py::kwargs& settings) {
             return Map::in_memory(places, size, close_loops, settings);
           }),
           py::arg("max_places"), py::arg("descriptor_size"), py::arg("close_loops") = false)
      .def_static(
          "open",
          [](const Argument<std::filesystem::path, "map">& map,
             const Argument<std::int64_t, "descriptor_size">& size,
             const Argument<std::optional<std::int64_t>, "max_places">& places,
             const Argument<std::string, "describer">& describer, const py::kwargs& settings) {
            return Map::open(map, size, places, describer, settings);
          },
          py::arg("map"), py::arg("descriptor_size"), py::arg("max_places") = py::none(),
          py::kw_only(), py::arg("describer") = "descriptors",
          "A map that lasts, in a file: the same as of `seqloop run --map` and `match --map`.\n\n"
          "One detector localises in all of its sessions, closes loops, and adds its drive as\n"
          "another session while it steps; finish() saves the rest. Several may share a map that\n"
          "is only read. `with` closes the file.\n"
          "map: made where it is missing. descriptor_size: D.\n"
          "max_places: most that it can hold; None: what it has and, unless it is only read,\n"
          "20,000 more, as with a live camera. With room for more than 20,480 a frame looks at\n"
          "more of the map, and a few answers change: those of `seqloop match --map` come with\n"
          "room for what the map has and as many more as the drive has frames.\n"
          "describer: what describes the drive, Describer.fingerprint or words of yours; only "
          "what\n"
          "was described alike can be compared.\n"
          "read_only: localise in it, and leave it as it is. session: name of this drive, when it\n"
          "began by default. save_every_s: seconds of driving that may be unsaved, 1. grow:\n"
          "'novel', places that later laps have seen often enough go, or 'all' stay.\n"
          "settings: as seqloop.settings() lists them.\n"
          "The file belongs to the process that opens it: in a fork of that, calls are refused\n"
          "and the file stays as it is. What is only read may be used there.\n"
          "Errors: SetupError: held by another process, of another form, damaged, no space, …")
      .def(
          "where",
          [](const std::shared_ptr<Map>& map, const Argument<std::uint64_t, "place">& place) {
            const auto [session, frame] = map->where(place);
            return std::pair(seqloop::python::readable(session), frame);
          },
          py::arg("place"),
          "(session, frame) where a place of a map in a file was seen; the frame is None once\n"
          "the place is forgotten. Errors: SetupError.")
      .def_property_readonly("saved", outliving(&Map::saved),
                             "Frames of this drive, from the first on, that are on the disk for\n"
                             "good; those of gaps of more than ds are not among them. Errors:\n"
                             "SetupError where the map is in no file.")
      .def("close", outliving(&Map::close),
           "Closes the file. What was stepped through since the last save, and not finished, is\n"
           "lost. A map in memory alone stays as it is.")
      .def(
          "__enter__", [](const py::object& map) { return map; }, "The map itself.")
      .def(
          "__exit__",
          [](const std::shared_ptr<Map>& map, const py::args& /*why*/) { map->close(); },
          "As close().")
      .def("add_drive", outliving(&Map::add_drive), py::arg("descriptors"),
           "Takes in the drive to localise in, whole: descriptors [N, D], floating point.\n\n"
           "Rows are brought to unit length; a blank row, all zeros, shows what the one before\n"
           "it showed. A map holds one drive. Errors: SetupError.")
      .def("__len__", outliving(&Map::size), "How many places it holds.")
      .def_property_readonly("capacity", outliving(&Map::capacity), "Most places.")
      .def_property_readonly("descriptor_size", outliving(&Map::descriptor_size),
                             "D, values in a descriptor.")
      .def("__repr__", outliving(&Map::text));

  py::class_<Stepper, std::shared_ptr<Stepper>>(
      module, "Detector",
      "Answers, frame by frame, whether the robot has been here before.\n\n"
      "map: keeps it alive. To localise: filled; several detectors may share it,\n"
      "one a thread. To close loops: empty, and this detector's alone.\n"
      "Errors: SetupError.")
      .def(py::init<const Argument<std::shared_ptr<Map>, "map">&>(), py::arg("map"))
      .def("step", outliving(&Stepper::step), py::arg("descriptor").none(true),
           py::arg("time_s") = py::none(),
           "Takes the next frame, and answers each frame whose answer is due.\n\n"
           "descriptor: float32 [D] in C order, of unit length; read where it lies, without a\n"
           "copy and without the interpreter's lock. None: the frame could not be read. NaN,\n"
           "infinity and zeros count as such a frame, too.\n"
           "time_s: when it was taken, seconds; a map in a file keeps it. None: ten frames a "
           "second.\n"
           "Errors: SetupError for another shape, type or length; then nothing has changed.")
      .def("skip", outliving(&Stepper::skip), py::arg("frames"),
           "Takes note of frames that never came: the camera lost them, or they were dropped.\n\n"
           "They are counted: the next frame's number is higher by as many. Up to ds of them are\n"
           "frames at which the scene stood still; with more, what was seen before says nothing\n"
           "of now. Errors: SetupError for more than can be counted, 92,000,000,000 in all.")
      .def("finish", outliving(&Stepper::finish),
           "The recording is over: answers every frame that still waits.\n\n"
           "A map in a file has all of the drive then. OSError: not all could be saved; the same\n"
           "call tries again, and gives the same answers.")
      .def("newest_column", outliving(&Stepper::newest_column),
           "The newest frame's column of the difference matrix, float32 [N]: NaN where nothing\n"
           "was computed, which is nearly everywhere unless all rows are candidates\n"
           "(method=\"seqcnnslam\"). Closing loops, frames that became no places have no row, so "
           "that\n"
           "rows are not the numbers of places. Errors: SetupError before the first step.")
      .def("__repr__", outliving(&Stepper::text));

  seqloop::python::add_recordings(module);
  seqloop::python::add_map_files(module);
}
