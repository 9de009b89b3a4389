// SPDX-License-Identifier: MIT
#include "python/bindings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "python/interpreter_lock.hpp"

namespace seqloop::python {
namespace {

namespace py = pybind11;

using program::Option;
using program::OptionTable;
using program::ValueKind;

std::string keyword(std::string name) {
  std::ranges::replace(name, '-', '_');
  return name;
}

/// `--decide-by uniqueness` becomes `decide_by uniqueness`; a command between ` and ` stays one.
std::string in_keywords(std::string_view text) {
  std::string out;
  bool command = false;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '`') command = !command;
    const bool flag = !command && text.substr(at).starts_with("--") && at + 2 < text.size() &&
                      text[at + 2] >= 'a' && text[at + 2] <= 'z';
    if (!flag) {
      out += text[at++];
      continue;
    }
    const std::size_t end =
        std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at + 2), text.size());
    out += keyword(std::string(text.substr(at + 2, end - at - 2)));
    at = end;
  }
  return out;
}

/// Whether these are names of options, such as `reference-positions, query-positions`.
bool are_names(std::string text) {
  const std::string_view between = ", ";
  for (std::size_t at = 0; (at = text.find(between)) != std::string::npos;) {
    text.erase(at, between.size());
  }
  return text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string::npos;
}

Fault in_keywords(const Fault& fault) {
  // The library's words, which know no settings, and no program.
  if (fault.what == "memory" && fault.remedy.starts_with("lower the capacity")) {
    return {fault.what, fault.why, "lower max_places; `seqloop plan` shows what each buffer takes"};
  }
  return {are_names(fault.what) ? keyword(fault.what) : in_keywords(fault.what),
          in_keywords(fault.why), in_keywords(fault.remedy)};
}

bool is_list(const py::handle& value) {
  return py::isinstance<py::tuple>(value) || py::isinstance<py::list>(value);
}

/// Text as the command line would have it: what Python could not read of a file's name is what it
/// was. Throws UnicodeEncodeError: it is nothing that was read.
std::string bytes(const py::handle& text) {
  const auto encoded = py::reinterpret_steal<py::bytes>(
      PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape"));
  if (!encoded) throw py::error_already_set();
  return encoded;
}

/// A value as the command line would have it; none where its type has no such form.
std::optional<std::string> value_text(const py::handle& value, ValueKind kind) {
  // Python's own, or NumPy's.
  py::detail::make_caster<bool> truth;
  if (!value.is_none() && truth.load(value, false)) {
    const bool on = py::detail::cast_op<bool>(truth);
    if (kind == ValueKind::flag) return on ? "true" : "false";
    if (kind == ValueKind::on_off) return on ? "on" : "off";
    return std::nullopt;
  }
  if (kind == ValueKind::flag) return std::nullopt;
  if (py::isinstance<py::str>(value)) return bytes(value);
  if (is_list(value)) {
    if (kind == ValueKind::count || kind == ValueKind::number) return std::nullopt;
    std::string text;
    for (const py::handle& each : value) {
      const auto one = is_list(each) ? std::nullopt : value_text(each, kind);
      if (!one) return std::nullopt;
      text += (text.empty() ? "" : kind == ValueKind::size ? "x" : ",") + *one;
    }
    return text;
  }
  if (py::hasattr(value, "__fspath__")) {
    return py::module_::import("os").attr("fsencode")(value).cast<std::string>();
  }
  const py::object number = py::module_::import("numbers").attr("Number");
  if (!py::isinstance(value, number)) return std::nullopt;
  if (kind == ValueKind::count && py::hasattr(value, "is_integer") &&
      value.attr("is_integer")().cast<bool>()) {
    return py::str(py::int_(py::reinterpret_borrow<py::object>(value))).cast<std::string>();
  }
  // A NumPy float32 of .9 is .9, not what it is as a double.
  return py::str(value).cast<std::string>();
}

}  // namespace

Faults set_options(const OptionTable& options, const py::kwargs& given, const std::string& listed) {
  Faults faults;
  std::vector<std::string> names;
  for (const Option& option : options.options()) names.push_back(option.name);
  for (const auto& [key, value] : given) {
    if (value.is_none()) continue;
    const std::string spelt = bytes(key);
    std::string name = spelt;
    std::ranges::replace(name, '_', '-');
    const Option* option = options.find(name);
    if (option == nullptr) {
      const std::string meant = program::nearest(name, names);
      faults.push_back(
          {"'" + spelt + "'", "is no setting",
           meant.empty() ? "see " + listed : "did you mean '" + keyword(meant) + "'?"});
      continue;
    }
    const auto text = value_text(value, option->kind);
    if (!text) {
      faults.push_back({name, shown(value) + " is not of its type",
                        option->kind == ValueKind::flag ? "give True or False" : option->help});
      continue;
    }
    if (option->kind == ValueKind::on_off && *text != "on" && *text != "off") {
      faults.push_back({name, shown(value) + " is neither True nor False"});
      continue;
    }
    for (Fault& fault : OptionTable::set(*option, *text)) faults.push_back(std::move(fault));
  }
  return faults;
}

py::dict described(const OptionTable& options) {
  py::dict all;
  for (const Option& option : options.options()) {
    all[py::str(keyword(option.name))] = in_keywords(option.help);
  }
  return all;
}

py::str readable(std::string_view text) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::list listed(const Faults& faults) {
  py::list list;
  for (const Fault& fault : faults) {
    const Fault said = in_keywords(fault);
    list.append(py::make_tuple(readable(said.what), readable(said.why), readable(said.remedy)));
  }
  return list;
}

void set_os_error(std::string_view text) { PyErr_SetObject(PyExc_OSError, readable(text).ptr()); }

void translate_faults(const py::object& error) {
  static py::object* const type = new py::object(error);  // as long as the process lives
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const SetupError& setup) {
      Faults faults;
      for (const Fault& fault : setup.faults()) faults.push_back(in_keywords(fault));
      py::object instance = (*type)(readable(SetupError(std::move(faults)).what()));
      instance.attr("faults") = listed(setup.faults());
      PyErr_SetObject(type->ptr(), instance.ptr());
    }
  });
}

std::string type_name(const py::handle& value) {
  return py::type::handle_of(value).attr("__name__").cast<std::string>();
}

std::string shown(const py::handle& value) {
  constexpr std::size_t most = 60;
  auto text = py::repr(value).cast<std::string>();
  const bool brief = text.size() <= most && text.find('\n') == std::string::npos;
  return brief ? text : "a value of type " + type_name(value);
}

bool is_masked(const py::handle& value) {
  return py::isinstance<Array>(value) && py::hasattr(value, "mask") &&
         value.attr("mask").attr("any")().cast<bool>();
}

Array array_of(const Given& given, const std::string& name, const Remedies& remedies) {
  const py::object& value = given.value;
  if (py::isinstance<Array>(value)) {
    if (is_masked(value)) {
      throw SetupError(
          {name, "some of it is masked, and would count all the same", remedies.unmasking});
    }
    return py::reinterpret_borrow<Array>(value);
  }
  if (py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__")) {
    const py::object path = py::module_::import("os").attr("fspath")(value);
    throw SetupError(
        {name, py::repr(path).cast<std::string>() + " is a name, not an array", remedies.reading});
  }
  throw SetupError(
      {name, "its type is " + type_name(value) + ", not numpy.ndarray", remedies.converting});
}

Array descriptors_of(const Given& given, const std::string& name) {
  return array_of(given, name,
                  {"numpy.load a described drive, or take describe_drive of pictures",
                   "leave those rows out, or give None for such a frame",
                   fmt::format("numpy.asarray({}, numpy.float32)", name)});
}

bool is_plain(const Array& array) {
  constexpr auto needed = static_cast<unsigned>(py::array::c_style) |
                          static_cast<unsigned>(py::detail::npy_api::NPY_ARRAY_ALIGNED_);
  return py::isinstance<py::array_t<float>>(array) &&
         (static_cast<unsigned>(array.flags()) & needed) == needed;
}

std::span<const float> descriptor(const Given& given, std::size_t size) {
  const Array array = descriptors_of(given, "descriptor");
  const bool fits = array.ndim() == 1 && static_cast<std::size_t>(array.size()) == size;
  if (fits && is_plain(array)) {
    return {static_cast<const float*>(array.data()), size};
  }
  const auto shape = py::str(array.attr("shape")).cast<std::string>();
  if (!fits) {
    throw SetupError({"descriptor", fmt::format("its shape is {}, the map's is ({},)", shape, size),
                      "give one descriptor, of the describer that made the map"});
  }
  const auto flags = static_cast<unsigned>(array.flags());
  if ((flags & py::detail::npy_api::NPY_ARRAY_ALIGNED_) == 0) {
    throw SetupError({"descriptor", "it does not lie at an address for floats",
                      "numpy.require(descriptor, numpy.float32, 'CA')"});
  }
  throw SetupError(
      {"descriptor",
       fmt::format(
           "it is {}{}", py::str(array.dtype()).cast<std::string>(),
           (flags & py::array::c_style) != 0 ? "" : ", and its values do not lie side by side"),
       "numpy.ascontiguousarray(descriptor, numpy.float32)"});
}

void look_for_interruption() {
  const Locked lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace seqloop::python
