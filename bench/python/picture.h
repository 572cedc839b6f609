// The renderer, its pictures, the truth and the score, for Python.
#pragma once

#include <pybind11/pybind11.h>

namespace wobblebench::python {

void add_pictures(pybind11::module_& module);

}  // namespace wobblebench::python
