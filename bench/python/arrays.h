// NumPy arrays that show memory of ours, and keep its owner alive.
#pragma once

#include <pybind11/numpy.h>

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/image.h"

namespace wobblebench::python {

namespace py = pybind11;

enum class Access { read, write };

/// `owner`: the Python object to which the memory belongs.
template <class Value>
py::array shown(const Value* data,
                const std::vector<py::ssize_t>& shape,
                const py::object& owner,
                Access access = Access::read) {
  py::array_t<Value> array(shape, data, owner);
  if (access == Access::read) array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// [row, column]
template <class Value>
py::array shown(const Image<Value>& image, const py::object& owner) {
  return shown(image.pixels.data(), {image.height, image.width}, owner);
}

/// [row, column, 3]
inline py::array shown(const Image<glm::vec3>& image, const py::object& owner) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  return shown(
      reinterpret_cast<const float*>(image.pixels.data()), {image.height, image.width, 3}, owner);
}

/// Bytes that are 0 or 1, as truth values.
inline py::array shown_flags(const std::vector<std::uint8_t>& flags,
                             const std::vector<py::ssize_t>& shape,
                             const py::object& owner) {
  return shown(flags.data(), shape, owner).attr("view")("bool");
}

}  // namespace wobblebench::python
