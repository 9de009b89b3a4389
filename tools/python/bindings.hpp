// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "program/options/options.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::python {

/// An array as Python gave it, of any type.
using Array = pybind11::array;

/// What Python gave in place of an array. Any value is taken, to be looked at with all others: what
/// pybind11 refuses itself is refused alone, and printed whole, each number of a list.
struct Given {
  pybind11::object value;
};

/// The name of an argument, as part of a type.
template <std::size_t size>
struct ArgumentName {
  char text[size] = {};  // NOLINT(*-avoid-c-arrays): what a literal is

  // NOLINTNEXTLINE(google-explicit-constructor,*-avoid-c-arrays)
  constexpr ArgumentName(const char (&literal)[size]) { std::copy_n(literal, size, text); }
};

/// Any other argument. One of a wrong type is told in a sentence, too.
template <class Value, ArgumentName name>
struct Argument {
  Value value{};

  operator const Value&() const noexcept { return value; }  // NOLINT(google-explicit-constructor)
};

/// What an argument must be.
template <class Value>
[[nodiscard]] std::string wanted() {
  if constexpr (requires { typename Value::element_type; }) {
    return "a seqloop." + pybind11::type::of<typename Value::element_type>()
                              .attr("__name__")
                              .template cast<std::string>();
  } else if constexpr (requires(Value value) { value.has_value(); }) {
    return wanted<typename Value::value_type>() + ", or None";
  } else if constexpr (std::is_same_v<Value, bool>) {
    return "True or False";
  } else if constexpr (std::is_floating_point_v<Value>) {
    return "a number";
  } else if constexpr (std::is_integral_v<Value>) {
    return std::is_signed_v<Value> ? "a whole number" : "a whole number of 0 or more";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return "text";
  } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
    return "the name of a file or folder";
  } else {
    static_assert(std::is_same_v<Value, std::vector<std::filesystem::path>>);
    return "a list of names of files";
  }
}

/// What a value is, in a word.
[[nodiscard]] std::string type_name(const pybind11::handle& value);

/// A value as Python writes it or, where that is long, its type.
[[nodiscard]] std::string shown(const pybind11::handle& value);

/// What to do about an argument that is no array, or not the one that is meant.
struct Remedies {
  std::string reading;     ///< it is the name of a file
  std::string unmasking;   ///< some of it is masked
  std::string converting;  ///< it is anything else
};

/// The array that was given. @param name of the argument
/// Throws SetupError: it is none.
[[nodiscard]] Array array_of(const Given& given, const std::string& name, const Remedies& remedies);

/// An array that should hold descriptors. Throws SetupError.
[[nodiscard]] Array descriptors_of(const Given& given, const std::string& name);

/// Sets options by keyword arguments: `full_map="thin"` for `--full-map thin`. True and False are
/// on and off, a list is its values with commas between; None leaves an option as it is.
/// @param listed where all of them are
/// @return everything that is wrong with them
[[nodiscard]] Faults set_options(const program::OptionTable& options, const pybind11::kwargs& given,
                                 const std::string& listed = "seqloop.settings()");

/// Name and help of every option, as keyword arguments.
[[nodiscard]] pybind11::dict described(const program::OptionTable& options);

/// Those of the options that `add` gives a table.
template <class Settings>
[[nodiscard]] pybind11::dict described(void (*add)(program::OptionTable&, Settings&)) {
  Settings settings;
  program::OptionTable options;
  add(options, settings);
  return described(options);
}

/// Text of a file, in which what is no UTF-8 becomes U+FFFD.
[[nodiscard]] pybind11::str readable(std::string_view text);

/// Whether some values of an array are masked, as numpy.ma has it: here they would count.
[[nodiscard]] bool is_masked(const pybind11::handle& value);

/// A tuple (what, why, remedy) for each fault, flags spelt as keyword arguments.
[[nodiscard]] pybind11::list listed(const Faults& faults);

/// Sets Python's error to an OSError. Its text may hold a file's name, which may be no UTF-8.
void set_os_error(std::string_view text);

/// From now on SetupError arrives in Python as `error`, of which `faults` holds the list of them.
void translate_faults(const pybind11::object& error);

/// Whether an array is float32 and lies in C order where floats may lie, so that it needs no copy.
[[nodiscard]] bool is_plain(const Array& array);

/// A descriptor, where it lies. @param size D
/// Throws SetupError: it is not float32 [D] in C order, where floats may lie.
[[nodiscard]] std::span<const float> descriptor(const Given& given, std::size_t size);

/// An array that takes over what was computed.
template <class Value>
[[nodiscard]] pybind11::array_t<Value> as_array(const std::vector<Value>& values,
                                                std::vector<pybind11::ssize_t> shape) {
  return pybind11::array_t<Value>(std::move(shape), values.data());
}

/// A call during which its object lives on: Python lets go of what a daemon thread uses when the
/// program ends.
template <class Self, class Result, class... Arguments>
[[nodiscard]] auto outliving(Result (Self::*call)(Arguments...)) {
  return [call](const std::shared_ptr<Self>& self, Arguments... arguments) {
    return ((*self).*call)(std::forward<Arguments>(arguments)...);
  };
}

/// Lets a long call end by Control-C: for code that runs without the interpreter's lock.
void look_for_interruption();

}  // namespace seqloop::python

namespace pybind11::detail {

template <>
class type_caster<seqloop::python::Given> {
 public:
  PYBIND11_TYPE_CASTER(seqloop::python::Given, const_name("numpy.ndarray"));

  bool load(handle given, bool /*convert*/) {
    value.value = reinterpret_borrow<object>(given);
    return true;
  }
};

template <class Value, seqloop::python::ArgumentName argument>
class type_caster<seqloop::python::Argument<Value, argument>> {
 public:
  using Taken = seqloop::python::Argument<Value, argument>;
  PYBIND11_TYPE_CASTER(Taken, make_caster<Value>::name);

  /// Throws type_error. What was made null by None would be used.
  bool load(handle given, bool convert) {
    make_caster<Value> inner;
    // Anything has a truth value, but True and False are meant.
    bool taken = inner.load(given, convert && !std::is_same_v<Value, bool>);
    if constexpr (requires { typename Value::element_type; }) taken = taken && !given.is_none();
    if (!taken) {
      const std::string wanted = seqloop::python::wanted<Value>();
      const bool large =
          wanted.starts_with("a whole") && isinstance<int_>(given) && given > int_(0);
      throw type_error(std::string(argument.text) + ": it must be " + wanted + ", not " +
                       (large ? "as much as " : "") + seqloop::python::shown(given));
    }
    value.value = cast_op<Value>(std::move(inner));
    return true;
  }
};

}  // namespace pybind11::detail
