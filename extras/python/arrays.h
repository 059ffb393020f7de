// Columns of the library as numpy arrays without a copy: the array holds on to the object that owns the memory, and is
// read-only, because a recording is what was measured.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/vec.h"

namespace touchstone::python {

namespace py = pybind11;

// The owner lives as long as an array refers to it.
inline py::capsule keep_alive(std::shared_ptr<const void> owner) {
  return py::capsule(new std::shared_ptr<const void>(std::move(owner)),
                     [](void* held) { delete static_cast<std::shared_ptr<const void>*>(held); });
}

// `columns` 0: one-dimensional.
template <class Number>
py::array view_of(const std::shared_ptr<const void>& owner, const Number* data, std::size_t rows, std::size_t columns) {
  const auto size = static_cast<py::ssize_t>(sizeof(Number));
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  std::vector<py::ssize_t> strides{size};
  if (columns > 0) {
    shape.push_back(static_cast<py::ssize_t>(columns));
    strides = {size * static_cast<py::ssize_t>(columns), size};
  }
  py::array array(py::dtype::of<Number>(), shape, strides, data, keep_alive(owner));
  array.attr("flags").attr("writeable") = false;
  return array;
}

inline py::array view_of(const std::shared_ptr<const void>& owner, const std::vector<double>& values) {
  return view_of(owner, values.data(), values.size(), 0);
}
inline py::array view_of(const std::shared_ptr<const void>& owner, const std::vector<Vec3>& values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return view_of(owner, values.empty() ? nullptr : values.front().data(), values.size(), 3);
}
// x, y, z, w: how they lie in memory.
inline py::array view_of(const std::shared_ptr<const void>& owner, const std::vector<Quat>& values) {
  static_assert(sizeof(Quat) == 4 * sizeof(double));
  return view_of(owner, values.empty() ? nullptr : values.front().coeffs().data(), values.size(), 4);
}
// None where the file has no such column.
template <class Value>
py::object view_or_none(const std::shared_ptr<const void>& owner, const std::vector<Value>& values) {
  if (values.empty()) return py::none();
  return view_of(owner, values);
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline void expect_shape(const py::array& given, const char* name, std::size_t columns) {
  const bool good =
      columns == 0 ? given.ndim() == 1 : given.ndim() == 2 && given.shape(1) == static_cast<py::ssize_t>(columns);
  if (good) return;
  std::string shape;
  for (py::ssize_t i = 0; i < given.ndim(); ++i) shape += (i > 0 ? ", " : "") + std::to_string(given.shape(i));
  throw UsageError(std::string(name) + " has the shape (" + shape + "); " +
                   (columns == 0 ? "(N,)" : "(N, " + std::to_string(columns) + ")") + " was expected");
}

inline std::vector<double> doubles_of(const Doubles& given, const char* name) {
  expect_shape(given, name, 0);
  return {given.data(), given.data() + given.size()};
}
inline std::vector<Vec3> vectors_of(const Doubles& given, const char* name) {
  expect_shape(given, name, 3);
  std::vector<Vec3> out(static_cast<std::size_t>(given.shape(0)));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = Vec3::Map(given.data() + 3 * i);
  return out;
}
inline std::vector<Quat> quaternions_of(const Doubles& given, const char* name) {
  expect_shape(given, name, 4);
  std::vector<Quat> out(static_cast<std::size_t>(given.shape(0)));
  for (std::size_t i = 0; i < out.size(); ++i) out[i].coeffs() = Eigen::Vector4d::Map(given.data() + 4 * i);
  return out;
}

// A new array of the vectors, for results that have no owner.
template <class Value>
py::array moved_to_array(std::vector<Value> values) {
  const auto owner = std::make_shared<const std::vector<Value>>(std::move(values));
  return view_of(owner, *owner);
}

}  // namespace touchstone::python
