// SPDX-License-Identifier: MIT
// The part of the package that looks at pictures: it loads OpenCV.
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "program/drives/describe_drive.hpp"
#include "program/drives/drives.hpp"
#include "program/options/verb.hpp"
#include "python/bindings.hpp"
#include "python/interpreter_lock.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

/// A picture, where it lies.
Image image(const Given& given) {
  const std::string unread = "step(None) tells the detector of a frame that could not be read";
  if (given.value.is_none()) {
    throw SetupError({"picture", "it is None, as of a picture that could not be read", unread});
  }
  const bool of_pil = py::hasattr(given.value, "__array_interface__");
  const Array picture =
      array_of(given, "picture",
               {"read it, with cv2.imread", "fill it first, picture.filled(0)",
                of_pil ? "where red comes first, as in PIL: "
                         "numpy.ascontiguousarray(numpy.asarray(picture.convert('RGB'))[..., ::-1])"
                       : "blue first: numpy.asarray(picture, numpy.uint8)"});
  const bool bytes = py::isinstance<py::array_t<std::uint8_t>>(picture);
  const bool gray = picture.ndim() == 2;
  const bool colour = picture.ndim() == 3 && picture.shape(2) == 3;
  if (picture.size() == 0) {
    throw SetupError({"picture",
                      "it is empty, of shape " + py::str(picture.attr("shape")).cast<std::string>(),
                      unread});
  }
  if (!bytes || (!gray && !colour)) {
    throw SetupError({"picture",
                      "it is " + py::str(picture.dtype()).cast<std::string>() + " of shape " +
                          py::str(picture.attr("shape")).cast<std::string>(),
                      "give uint8 [H, W], grey, or [H, W, 3], blue first"});
  }
  constexpr py::ssize_t most = 16'384;
  const py::ssize_t pixel = colour ? 3 : 1;
  const bool together = picture.strides(1) == pixel && (gray || picture.strides(2) == 1) &&
                        picture.strides(0) >= pixel * picture.shape(1);
  if (!together || picture.shape(0) > most || picture.shape(1) > most) {
    throw SetupError(
        {"picture",
         together ? "it is larger than 16384x16384" : "its pixels do not lie side by side",
         together ? "make it smaller" : "numpy.ascontiguousarray(picture)"});
  }
  return {static_cast<const std::uint8_t*>(picture.data()), static_cast<int>(picture.shape(1)),
          static_cast<int>(picture.shape(0)), static_cast<std::size_t>(picture.strides(0)),
          colour ? PixelFormat::bgr8 : PixelFormat::gray8};
}

/// What describes pictures, for one thread at a time.
class PictureDescriber {
 public:
  explicit PictureDescriber(const py::kwargs& given) {
    program::OptionTable options;
    program::add_drive_options(options, settings_);
    Faults faults = set_options(options, given, "seqloop.Describer.settings()");
    program::collect(faults, [&] {
      if (faults.empty()) {
        const Unlocked unlocked;
        describer_ = program::open_describer(settings_);
      } else {
        program::check_describer(settings_, !settings_.training.empty());
      }
    });
    program::refuse(std::move(faults));
  }

  [[nodiscard]] std::size_t size() { return describer_->size(); }

  [[nodiscard]] std::string fingerprint() { return program::fingerprint(settings_); }

  py::array_t<float> describe(const Given& picture) {
    const Image looked_at = image(picture);
    py::array_t<float> descriptor(static_cast<py::ssize_t>(size()));
    const std::span<float> values(descriptor.mutable_data(), size());
    const Unlocked unlocked;
    const std::scoped_lock lock(mutex_);
    if (describer_->describe(looked_at, values) == Description::failed) {
      throw SetupError(Fault{"picture", std::string(describer_->last_fault())});
    }
    return descriptor;
  }

  py::array_t<float> describe_drive(const Argument<std::filesystem::path, "source">& given,
                                    const Argument<std::size_t, "frames">& frames) {
    const std::filesystem::path& source = given;
    std::vector<float> rows;
    {
      const Unlocked unlocked;
      const std::scoped_lock lock(mutex_);
      if (program::is_described(source)) {
        throw SetupError({"source", source.string() + " holds descriptors already",
                          "numpy.load(source), or give an image folder or a video"});
      }
      const auto drive = program::open_drive(source, "source", settings_, describer_.get());
      program::Progress silent;
      (void)program::describe_drive(source.string(), *drive, *describer_,
                                    [&rows](std::span<const float> row) {
                                      look_for_interruption();
                                      rows.insert(rows.end(), row.begin(), row.end());
                                    },
                                    silent, {.rows = frames});
    }
    return as_array(
        rows, {static_cast<py::ssize_t>(rows.size() / size()), static_cast<py::ssize_t>(size())});
  }

 private:
  std::mutex mutex_;
  program::DriveSettings settings_;
  std::unique_ptr<Describer> describer_;
};

}  // namespace
}  // namespace seqloop::python

PYBIND11_MODULE(_vision, module) {
  namespace py = pybind11;
  using seqloop::python::outliving;
  using seqloop::python::PictureDescriber;
  module.doc() = "Describing pictures. Use it through the package seqloop.";
  seqloop::python::translate_faults(py::module_::import("seqloop._errors").attr("SetupError"));
  py::class_<PictureDescriber, std::shared_ptr<PictureDescriber>>(
      module, "Describer",
      "Turns pictures into descriptors: by what is built in or, with settings, by a model that\n"
      "OpenCV reads (model=, layer=, input_size=, mean=, scale=, swap_rb=), by SeqSLAM's patches\n"
      "(descriptor=\"patches\"), or by words learnt from drives (descriptor=\"words\", "
      "training=).\n"
      "Errors: SetupError, a ValueError with every fault at once.")
      .def(py::init<const py::kwargs&>())
      .def_static(
          "settings",
          [] { return seqloop::python::described(seqloop::program::add_drive_options); },
          "Every setting of a describer, and what it does.")
      .def_property_readonly("size", outliving(&PictureDescriber::size),
                             "D, values in a descriptor.")
      .def_property_readonly("fingerprint", outliving(&PictureDescriber::fingerprint),
                             "What a map in a file remembers of how it was described: all that\n"
                             "makes descriptors differ. For PlaceMap.open.")
      .def("describe", outliving(&PictureDescriber::describe), py::arg("picture"),
           "The descriptor of one picture: float32 [D], of unit length, or zeros where the\n"
           "picture has no feature; patches are 0 to 255 instead.\n\n"
           "picture: uint8 [H, W], grey, or [H, W, 3], blue first as OpenCV has it; rows may be\n"
           "padded. Read where it lies, without the interpreter's lock. Errors: SetupError.")
      .def("describe_drive", outliving(&PictureDescriber::describe_drive), py::arg("source"),
           py::arg("frames") = 0,
           "The descriptors of a drive, float32 [N, D], the same as `seqloop describe` writes.\n\n"
           "source: a folder of pictures, or a video; frames: stop after so many, 0: all.\n"
           "A frame that cannot be read is a row of zeros, which a line on stderr says.\n"
           "Errors: SetupError.");
}
