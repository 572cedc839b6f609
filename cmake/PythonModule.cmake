# Whether the Python module is built (bench/python): sets wobblebench_python. Everything is compiled so that it can be
# linked into a shared library, whether or not it is, so that the presets `run` and `release` share their objects.
include_guard()
set(WOBBLEBENCH_PYTHON AUTO CACHE STRING "The Python module: AUTO (if pybind11 and Python's headers are here), ON or OFF")
set_property(CACHE WOBBLEBENCH_PYTHON PROPERTY STRINGS AUTO ON OFF)
if(NOT WOBBLEBENCH_PYTHON MATCHES "^(AUTO|ON|OFF)$")
  message(FATAL_ERROR "WOBBLEBENCH_PYTHON = ${WOBBLEBENCH_PYTHON}: must be AUTO, ON or OFF")
endif()
set(wobblebench_python OFF)
if(NOT WOBBLEBENCH_RENDER_ONLY AND NOT WOBBLEBENCH_SANITIZE)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  # Our own functions are still inlined.
  add_compile_options(-fno-semantic-interposition)
endif()
# An interpreter without the sanitizer's runtime cannot load what was built with it.
if(WOBBLEBENCH_PYTHON STREQUAL "OFF" OR WOBBLEBENCH_RENDER_ONLY OR WOBBLEBENCH_SANITIZE)
  return()
endif()

# Debian's interpreter first: it has Debian's NumPy.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
set(PYBIND11_FINDPYTHON ON)
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 QUIET)
if(Python_FOUND AND pybind11_FOUND)
  set(wobblebench_python ON)
elseif(WOBBLEBENCH_PYTHON STREQUAL "ON")
  message(FATAL_ERROR "WOBBLEBENCH_PYTHON = ON, but pybind11 or Python's headers are not here: install pybind11-dev and python3-dev")
endif()
message(STATUS "Python module: ${wobblebench_python}")
