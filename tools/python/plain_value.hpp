// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>

namespace seqloop::python {

/// What a value holds under a name, and what that means.
template <class Owner, class Value>
struct Member {
  const char* name;
  Value Owner::*at;
  const char* meaning;
};

template <class Owner, class Value>
[[nodiscard]] Member<Owner, Value> member(const char* name, Value Owner::*at, const char* meaning) {
  return {name, at, meaning};
}

/// A class of values that Python cannot change: they can be shown, copied, pickled and compared.
template <class Value, class... Owners, class... Held>
pybind11::class_<Value> add_plain_value(pybind11::module_& module, const char* name,
                                        const char* meaning, Member<Owners, Held>... members) {
  namespace py = pybind11;
  py::class_<Value> type(module, name, meaning);
  (type.def_property_readonly(
       members.name, [at = members.at](const Value& value) { return value.*at; }, members.meaning),
   ...);
  type.def("__repr__", [name, members...](const Value& value) {
    std::string text;
    ((text += (text.empty() ? "" : ", ") + std::string(members.name) + "=" +
              py::repr(py::cast(value.*members.at)).template cast<std::string>()),
     ...);
    return std::string(name) + "(" + text + ")";
  });
  // All that it holds is in its text, and NaN is NaN there.
  type.def("__eq__", [](const py::object& value, const py::object& other) -> py::object {
    if (!py::isinstance<Value>(other)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(py::repr(value).equal(py::repr(other)));
  });
  type.def("__hash__", [](const py::object& value) { return py::hash(py::repr(value)); });
  // By itself it would end the interpreter with the protocols 0 and 1, which know no `__new__`.
  type.def("__reduce__", [](const py::object& value) {
    return py::make_tuple(py::module_::import("copyreg").attr("__newobj__"),
                          py::make_tuple(py::type::of(value)), value.attr("__getstate__")());
  });
  type.def(
      py::pickle([members...](const Value& value) { return py::make_tuple(value.*members.at...); },
                 [members...](const py::tuple& held) {
                   Value value;
                   std::size_t next = 0;
                   ((value.*members.at = held[next++].template cast<Held>()), ...);
                   return value;
                 }));
  return type;
}

}  // namespace seqloop::python
