#include "errors.h"

#include <exception>

#include "retalho/core/error.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

// Owned by the module, which lives as long as the interpreter.
struct Types {
  PyObject *usage = nullptr, *bad_input = nullptr, *cannot_read = nullptr, *cannot_write = nullptr, *internal = nullptr;
};
Types types;

PyObject* type_of(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::usage:
      return types.usage;
    case Error::Kind::bad_input:
      return types.bad_input;
    case Error::Kind::cannot_read:
      return types.cannot_read;
    case Error::Kind::cannot_write:
      return types.cannot_write;
    default:
      return types.internal;
  }
}

void raise(const Error& error) {
  if (error.kind() == Error::Kind::interrupted) return PyErr_SetNone(PyExc_KeyboardInterrupt);
  try {
    const auto type = py::reinterpret_borrow<py::object>(type_of(error.kind()));
    const py::object instance = type(error.what());
    instance.attr("kind") = kind_name(error.kind());
    instance.attr("file") = error.file();
    instance.attr("where") = error.where();
    PyErr_SetObject(type.ptr(), instance.ptr());
  } catch (py::error_already_set& failure) {
    failure.restore();
  }
}

PyObject* make(py::module_& module, const char* name, const char* words, const py::tuple& bases) {
  const std::string full = std::string("retalho.") + name;
  PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), words, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.add_object(name, type);
  return type;
}

}  // namespace

void add_errors(py::module_& module) {
  const auto of = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
  types.internal = make(module, "Error",
                        "What Retalho raises on purpose. `kind`: the cause, as in the program's JSON (\"bad_input\"); "
                        "`file` and `where`: the place, or empty.",
                        py::make_tuple(of(PyExc_Exception)));
  const py::object error = of(types.internal), value = of(PyExc_ValueError), os = of(PyExc_OSError);
  const py::tuple values = py::make_tuple(error, value), files = py::make_tuple(error, os);
  types.usage = make(module, "UsageError", "Options that contradict each other or are out of range.", values);
  types.bad_input = make(module, "BadInput", "The data can be read, but not used: wrong shape or content.", values);
  types.cannot_read = make(module, "CannotRead", "A file is missing, unreadable, unknown or damaged.", files);
  types.cannot_write = make(module, "CannotWrite", "A file exists already, or cannot be made.", files);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& failure) {
      raise(failure);
    }
  });
}

}  // namespace retalho::python
