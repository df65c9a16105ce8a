// The extension module retalho._retalho: arguments, one call and arrays out. Nothing is computed here or in Python.
#include <pybind11/pybind11.h>

#include "bicubic.h"
#include "compare.h"
#include "contours.h"
#include "curves.h"
#include "errors.h"
#include "formats.h"
#include "formulas.h"
#include "grid.h"
#include "mesh.h"
#include "model.h"
#include "patches.h"
#include "pictures.h"
#include "points.h"
#include "terrain.h"
#include "tetraquad.h"
#include "tiled_model.h"
#include "tiles.h"
#include "visibility.h"

PYBIND11_MODULE(_retalho, module) {
  namespace python = retalho::python;
  module.doc() = "Smooth surfaces made of polynomial patches.";
  module.attr("__version__") = RETALHO_VERSION;
  python::add_errors(module);
  python::add_grid(module);
  python::add_terrain(module);
  python::add_fit(module);
  python::add_bicubic(module);
  python::add_contours(module);
  python::add_compare(module);
  python::add_visibility(module);
  python::add_sight(module);
  python::add_points(module);
  python::add_mesh(module);
  python::add_curves(module);
  python::add_curve_measures(module);
  python::add_formulas(module);
  python::add_curve_files(module);
  python::add_conics(module);
  python::add_patches(module);
  python::add_tetraquad(module);
  python::add_tetraquad_fit(module);
  python::add_model(module);
  python::add_tiles(module);
  python::add_tiled_model(module);
  python::add_formats(module);
  python::add_pictures(module);
  python::add_shape_pictures(module);
}
