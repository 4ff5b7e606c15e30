#include "arrays.hpp"

namespace cleave::python {

py::array sealed(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace cleave::python
