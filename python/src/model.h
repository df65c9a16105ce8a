// Model files, and pickling through them.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>

#include "retalho/model/model.h"

namespace retalho::python {

pybind11::object to_object(Model model);
/// What an object of the module's holds, as a model. Each class has one.
Model to_model(const pybind11::handle& object);
/// A str or os.PathLike. Throws TypeError.
std::string path_text(const pybind11::object& path);

pybind11::bytes encode(const pybind11::handle& object);
pybind11::object decode(const pybind11::bytes& bytes);
void save(const pybind11::handle& object, const pybind11::object& path, bool overwrite);

/// save, to_bytes, from_bytes and pickling on a class.
template <class Class>
void add_model_methods(Class& defined) {
  namespace py = pybind11;
  defined.def(
      "save", [](const py::object& self, const py::object& path, bool overwrite) { save(self, path, overwrite); },
      py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
      "Writes the model file (.retalho); complete or absent. Raises CannotWrite.");
  defined.def(
      "to_bytes", [](const py::object& self) { return encode(self); }, "The model file's bytes.");
  defined.def(py::pickle([](const py::object& self) { return encode(self); },
                         [](const py::bytes& bytes) { return py::cast<typename Class::holder_type>(decode(bytes)); }));
}

/// load, from_bytes.
void add_model(pybind11::module_& module);

}  // namespace retalho::python
