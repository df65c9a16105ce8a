// NumPy arrays in and out. In: anything that numpy.asarray takes; masked entries become NaN. Out: arrays that own what
// C++ computed, or read-only views of it, without a copy.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho::python {

using Shape = std::vector<pybind11::ssize_t>;
using Doubles = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// "(3, 4)".
std::string shape_text(const pybind11::array& array);

/// As numpy.asarray; `mask` gets the mask of a masked array (else None). Throws TypeError for what holds no numbers.
pybind11::array as_array(const pybind11::object& object, const std::string& name, pybind11::object& mask);
/// C-ordered doubles; masked entries are NaN.
Doubles as_doubles(const pybind11::object& object, const std::string& name);

/// n points of two or three numbers from an array of shape (n, 2) or (n, 3). Throws BadInput with the shape.
std::vector<Vec2> as_points2(const pybind11::object& object, const std::string& name);
std::vector<Vec3> as_points3(const pybind11::object& object, const std::string& name);
/// (n, 2) or (n, 3), z = 0 in the plane; `dimension` says which.
std::vector<Vec3> as_points(const pybind11::object& object, const std::string& name, int& dimension);
/// A vector from an array of shape (n,).
std::vector<double> as_vector(const pybind11::object& object, const std::string& name);

/// Two arrays broadcast against each other, as doubles.
struct Pair {
  Doubles x, y;
  Shape shape;  ///< of the result; empty: two plain numbers
  std::size_t size() const { return static_cast<std::size_t>(x.size()); }
  Vec2 at(std::size_t i) const { return {x.data()[i], y.data()[i]}; }
};
Pair broadcast(const pybind11::object& x, const pybind11::object& y, const std::string& names);

/// An array that takes over `values`. `Scalar`: what Element is made of.
template <class Scalar, class Element>
pybind11::array_t<Scalar> own(std::vector<Element>&& values, Shape shape) {
  auto* kept = new std::vector<Element>(std::move(values));
  const pybind11::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Element>*>(p); });
  return pybind11::array_t<Scalar>(std::move(shape), reinterpret_cast<const Scalar*>(kept->data()), owner);
}

/// A read-only view of memory that `owner` keeps alive.
template <class Scalar>
pybind11::array_t<Scalar> view(const void* data, Shape shape, const pybind11::handle& owner) {
  pybind11::array_t<Scalar> array(std::move(shape), static_cast<const Scalar*>(data), owner);
  array.attr("setflags")(pybind11::arg("write") = false);
  return array;
}

inline pybind11::ssize_t count_of(std::size_t n) {
  return static_cast<pybind11::ssize_t>(n);
}

/// One value for plain numbers, else the array of that shape.
pybind11::object shaped(std::vector<double>&& values, const Shape& shape);

}  // namespace retalho::python
