#include "arrays.h"

#include <fmt/format.h>

#include "retalho/core/error.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

py::module_ numpy() {
  return py::module_::import("numpy");
}

const double* row_of(const Doubles& array, std::size_t i, py::ssize_t width) {
  return array.data() + static_cast<std::size_t>(width) * i;
}

/// (n, width) for one of the widths; a single point of shape (width,) is one row.
Doubles as_rows(const py::object& object, const std::string& name, py::ssize_t least, py::ssize_t most) {
  Doubles array = as_doubles(object, name);
  if (array.ndim() == 1 && array.shape(0) >= least && array.shape(0) <= most)
    array = array.attr("reshape")(1, -1).cast<Doubles>();
  if (array.ndim() == 2 && array.shape(1) >= least && array.shape(1) <= most) return array;
  throw BadInput(fmt::format("{} must have the shape (n, {}){}, not {}", name, least,
                             most > least ? fmt::format(" or (n, {})", most) : "", shape_text(array)),
                 {}, name);
}

}  // namespace

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k) text += fmt::format("{}{}", k > 0 ? ", " : "", array.shape(k));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

py::array as_array(const py::object& object, const std::string& name, py::object& mask) {
  mask = py::none();
  py::object plain = object;
  const py::module_ masked = py::module_::import("numpy.ma");
  if (py::isinstance(object, masked.attr("MaskedArray"))) {
    mask = masked.attr("getmaskarray")(object);
    plain = masked.attr("getdata")(object);
  }
  const auto array = py::cast<py::array>(numpy().attr("asarray")(plain));
  const char kind = array.dtype().kind();
  if (kind == 'b' || kind == 'i' || kind == 'u' || kind == 'f') return array;
  throw py::type_error(fmt::format("{} must hold real numbers, not {} (shape {})", name,
                                   py::cast<std::string>(py::str(array.dtype())), shape_text(array)));
}

Doubles as_doubles(const py::object& object, const std::string& name) {
  py::object mask;
  const py::array array = as_array(object, name, mask);
  if (mask.is_none()) return py::cast<Doubles>(array);
  const py::object copy = array.attr("astype")("float64");
  numpy().attr("putmask")(copy, mask, std::numeric_limits<double>::quiet_NaN());
  return py::cast<Doubles>(copy);
}

std::vector<Vec2> as_points2(const py::object& object, const std::string& name) {
  const Doubles array = as_rows(object, name, 2, 2);
  std::vector<Vec2> points(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {row_of(array, i, 2)[0], row_of(array, i, 2)[1]};
  return points;
}

std::vector<Vec3> as_points3(const py::object& object, const std::string& name) {
  const Doubles array = as_rows(object, name, 3, 3);
  std::vector<Vec3> points(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double* p = row_of(array, i, 3);
    points[i] = {p[0], p[1], p[2]};
  }
  return points;
}

std::vector<Vec3> as_points(const py::object& object, const std::string& name, int& dimension) {
  const Doubles array = as_rows(object, name, 2, 3);
  dimension = static_cast<int>(array.shape(1));
  std::vector<Vec3> points(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double* p = row_of(array, i, dimension);
    points[i] = {p[0], p[1], dimension == 3 ? p[2] : 0};
  }
  return points;
}

std::vector<double> as_vector(const py::object& object, const std::string& name) {
  const Doubles array = as_doubles(object, name);
  if (array.ndim() == 0) return {*array.data()};
  if (array.ndim() != 1)
    throw BadInput(fmt::format("{} must have the shape (n,), not {}", name, shape_text(array)), {}, name);
  return {array.data(), array.data() + array.size()};
}

Pair broadcast(const py::object& x, const py::object& y, const std::string& names) {
  Pair pair;
  pair.x = as_doubles(x, names);
  pair.y = as_doubles(y, names);
  py::list both;
  try {
    both = py::list(numpy().attr("broadcast_arrays")(pair.x, pair.y));
  } catch (py::error_already_set&) {
    throw BadInput(
        fmt::format("{} do not go together: their shapes are {} and {}", names, shape_text(pair.x), shape_text(pair.y)),
        {}, names);
  }
  pair.x = py::cast<Doubles>(both[0]);
  pair.y = py::cast<Doubles>(both[1]);
  pair.shape.assign(pair.x.shape(), pair.x.shape() + pair.x.ndim());
  return pair;
}

py::object shaped(std::vector<double>&& values, const Shape& shape) {
  if (shape.empty()) return py::float_(values.at(0));
  return own<double>(std::move(values), shape);
}

}  // namespace retalho::python
