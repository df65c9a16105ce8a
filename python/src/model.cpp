#include "model.h"

#include <string_view>
#include <utility>
#include <variant>

#include "patches.h"
#include "running.h"
#include "terrain.h"
#include "tetraquad.h"

namespace py = pybind11;

namespace retalho::python {

py::object to_object(Model model) {
  return std::visit(
      [](auto&& shape) -> py::object {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, Terrain>)
          return py::cast(std::make_shared<TerrainModel>(std::move(shape)));
        else if constexpr (std::is_same_v<Shape, TetraQuad>)
          return py::cast(std::make_shared<TetraQuadModel>(std::move(shape)));
        else
          return py::cast(std::make_shared<Patches>(std::move(shape.patches)));
      },
      std::move(model));
}

Model to_model(const py::handle& object) {
  if (py::isinstance<TerrainModel>(object)) return py::cast<const TerrainModel&>(object).terrain();
  if (py::isinstance<TetraQuadModel>(object)) return py::cast<const TetraQuadModel&>(object).surface();
  return PatchSet{py::cast<const Patches&>(object).patches()};
}

std::string path_text(const py::object& path) {
  return py::cast<std::string>(py::module_::import("os").attr("fsdecode")(path));
}

py::bytes encode(const py::handle& object) {
  const Model model = to_model(object);
  return py::bytes(run(Running{}, [&](const Context&) { return encode_model(model); }));
}

py::object decode(const py::bytes& bytes) {
  const std::string_view view = bytes;
  return to_object(run(Running{}, [&](const Context&) { return decode_model(view); }));
}

void save(const py::handle& object, const py::object& path, bool overwrite) {
  const Model model = to_model(object);
  const std::string name = path_text(path);
  run(Running{}, [&](const Context&) { save_model(model, name, overwrite); });
}

void add_model(py::module_& module) {
  module.def(
      "load",
      [](const py::object& path) {
        const std::string name = path_text(path);
        return to_object(run(Running{}, [&](const Context&) { return load_model(name); }));
      },
      py::arg("path"),
      "The model in a file (.retalho): a Terrain, a TetraQuad or a PatchSet, equal to the one saved to the last bit. "
      "Raises CannotRead for anything that is not a whole, unchanged model file.");
  module.def("from_bytes", &decode, py::arg("data"), "The same from the file's bytes.");
}

}  // namespace retalho::python
