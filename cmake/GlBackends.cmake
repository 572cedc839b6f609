# Where OpenGL contexts come from in this build: OSMesa (which Mesa 25.1 removed), EGL, or both. Sets
# gl_backend_sources, gl_backend_include_dirs and gl_backend_definitions.
include_guard()
set(gl_backend_sources)
set(gl_backend_include_dirs)
set(gl_backend_definitions)

# gl_backend(NAME header package source): adds the backend if WOBBLEBENCH_NAME wants it and its header is here.
macro(gl_backend name header package source)
  set(WOBBLEBENCH_${name} AUTO CACHE STRING "Contexts of ${name}: AUTO (if ${header} is here), ON or OFF")
  set_property(CACHE WOBBLEBENCH_${name} PROPERTY STRINGS AUTO ON OFF)
  if(NOT WOBBLEBENCH_${name} MATCHES "^(AUTO|ON|OFF)$")
    message(FATAL_ERROR "WOBBLEBENCH_${name} = ${WOBBLEBENCH_${name}}: must be AUTO, ON or OFF")
  endif()
  if(NOT WOBBLEBENCH_${name} STREQUAL "OFF")
    find_path(${name}_INCLUDE_DIR ${header})
    if(${name}_INCLUDE_DIR)
      list(APPEND gl_backend_sources ${source})
      list(APPEND gl_backend_include_dirs "${${name}_INCLUDE_DIR}")
      list(APPEND gl_backend_definitions WOBBLEBENCH_HAS_${name})
    elseif(WOBBLEBENCH_${name} STREQUAL "ON")
      message(FATAL_ERROR "WOBBLEBENCH_${name} = ON, but ${header} is not here: install ${package}")
    endif()
  endif()
endmacro()

gl_backend(OSMESA GL/osmesa.h libosmesa6-dev gl/osmesa.cpp)
gl_backend(EGL EGL/egl.h libegl-dev gl/egl.cpp)
if(NOT gl_backend_sources)
  message(FATAL_ERROR "render needs EGL/egl.h or GL/osmesa.h: install libegl-dev or libosmesa6-dev "
    "(WOBBLEBENCH_EGL = ${WOBBLEBENCH_EGL}, WOBBLEBENCH_OSMESA = ${WOBBLEBENCH_OSMESA})")
endif()
message(STATUS "OpenGL contexts: ${gl_backend_definitions}")
