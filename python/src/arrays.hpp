#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"

/// NumPy arrays that look into memory of a result and keep it alive; nothing is copied, nothing can be written.
namespace cleave::python {

namespace py = pybind11;

[[nodiscard]] py::array sealed(py::array array);

/// One number of each item of a row of structs: `field(item)` is a reference into it.
template <class Number, class Item, class Field>
[[nodiscard]] py::array column(std::span<const Item> items, const Field& field, const py::object& owner) {
  const auto count = static_cast<py::ssize_t>(items.size());
  if (items.empty()) return sealed(py::array_t<Number>(std::size_t{0}));
  const void* const first = &field(items.front());
  return sealed(py::array(py::dtype::of<Number>(), {count}, {static_cast<py::ssize_t>(sizeof(Item))}, first, owner));
}

/// The same of a vector: an array of n times 3.
template <class Item, class Field>
[[nodiscard]] py::array vectors(std::span<const Item> items, const Field& field, const py::object& owner) {
  static_assert(sizeof(geometry::Vec3) == 3 * sizeof(double));
  const auto count = static_cast<py::ssize_t>(items.size());
  if (items.empty()) return sealed(py::array_t<double>(std::vector<py::ssize_t>{0, 3}));
  const void* const first = &field(items.front());
  return sealed(py::array(py::dtype::of<double>(), {count, py::ssize_t{3}},
                          {static_cast<py::ssize_t>(sizeof(Item)), static_cast<py::ssize_t>(sizeof(double))}, first,
                          owner));
}

/// All of a vector of numbers.
template <class Number>
[[nodiscard]] py::array numbers(std::span<const Number> items, const py::object& owner) {
  return column<Number>(items, [](const Number& n) -> const Number& { return n; }, owner);
}

}  // namespace cleave::python
