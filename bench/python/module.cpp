// The Python module: bindings of the rooms' own functions, without a computation of its own.
#include <pybind11/pybind11.h>

#include "bench/output/report_parts.h"
#include "bench/python/calls.h"
#include "bench/python/picture.h"
#include "bench/python/scan.h"
#include "bench/python/scene.h"

PYBIND11_MODULE(_wobblebench, module) {
  using namespace wobblebench::python;
  add_exceptions(module);
  add_scene(module);
  add_scan(module);
  add_pictures(module);
  module.attr("__version__") = wobblebench::bench::version_line("wobblebench");
}
