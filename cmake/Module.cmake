# How this project builds a module and a program: one place for flags, aliases and include paths.
include_guard()
include(GNUInstallDirs)
include(TestTiers)
# CTest reads it by itself; tests of add_test wait for the next configuring.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${wobblebench_seconds_file}")

# Flags of every target of ours. Contraction is off so that results match across machines; a designated
# initialiser that names only what differs from the defaults is how we write options.
function(wobblebench_flags target)
  wobblebench_unity(${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Wno-missing-field-initializers -ffp-contract=off)
  if(WOBBLEBENCH_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(WOBBLEBENCH_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${WOBBLEBENCH_SANITIZE}
      -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${WOBBLEBENCH_SANITIZE})
  endif()
endfunction()

# wobblebench_unity(TARGET): compiles the sources of a folder as one, in groups of at most eight, so that their headers
# are read and their templates instantiated once. A folder is one of a room with those below it; of bench/studies, each.
# Names in anonymous namespaces are therefore unique within it. A source that has a UNITY_GROUP already stays in that.
# The presets `dev` and `render-only` compile each source by itself, so that no include is missing where it is used.
option(WOBBLEBENCH_UNITY "Compile the sources of a folder as one" ON)
function(wobblebench_unity target)
  if(NOT WOBBLEBENCH_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  foreach(source IN LISTS sources)
    get_source_file_property(group "${source}" UNITY_GROUP)
    if(NOT group)
      cmake_path(ABSOLUTE_PATH source NORMALIZE OUTPUT_VARIABLE path)
      cmake_path(RELATIVE_PATH path BASE_DIRECTORY "${PROJECT_SOURCE_DIR}")
      string(REGEX MATCH "^(tests/)?(bench/studies(/[^/]+)+|[^/]+(/[^/]+)?)/" folder "${path}")
      string(MAKE_C_IDENTIFIER "${folder}" group)
    endif()
    math(EXPR members_${group} "${members_${group}} + 1")
    math(EXPR part "(${members_${group}} - 1) / 8")
    set_property(SOURCE "${source}" PROPERTY UNITY_GROUP "${group}${part}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # GCC takes each included source for a header, whose classes may not hold types of anonymous namespaces.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# wobblebench_optimise(TARGET LEVEL): of release builds; `1` for what has no loop over samples or pixels.
function(wobblebench_optimise target level)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O${level}>)
endfunction()

# wobblebench_precompile(TARGET HEADERS…): reading headers is half of a build, so the heavy ones are read once a
# target. The presets `dev` and `render-only` build without, so that no include is missing where it is used.
option(WOBBLEBENCH_PRECOMPILE "Precompile heavy headers" ON)
function(wobblebench_precompile target)
  if(WOBBLEBENCH_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# wobblebench_module(NAME [COMPONENT component] SOURCES a.cpp … PUBLIC lib … PRIVATE lib …)
# A static library `wobblebench_NAME`, alias `wobblebench::NAME`, installed with the component of that name unless
# another is given (cmake/Install.cmake). Our sources include its headers by their path below the project; installed
# ones lie below wobblebench/.
function(wobblebench_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "COMPONENT" "SOURCES;PUBLIC;PRIVATE")
  if(NOT arg_COMPONENT)
    set(arg_COMPONENT ${name})
  endif()
  set(target wobblebench_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(wobblebench::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  wobblebench_flags(${target})
  wobblebench_install_library(${target} ${arg_COMPONENT})
endfunction()

# Puts the library into the targets file of its component, and into the package that holds the component.
function(wobblebench_install_library target component)
  set(package dev)
  if(component MATCHES "^(tables|phantoms|sim|bench)$")
    set(package bench-dev)
  endif()
  install(TARGETS ${target} EXPORT wobblebench-${component} ARCHIVE COMPONENT ${package})
endfunction()

# wobblebench_test(NAME SOURCES a_test.cpp … LIBS lib … [NIGHTLY Suite …] [SERIAL Suite …]): one GoogleTest
# program; each of its suites is a CTest test. Not each case: a process loads some 50 shared libraries first, and what a
# suite's cases share is made once. NIGHTLY: suites that take too long for each change. SERIAL: suites that are held to
# deadlines of milliseconds, and therefore run without others beside them.
function(wobblebench_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBS;NIGHTLY;SERIAL")
  set(seconds 900)
  if(WOBBLEBENCH_SANITIZE)
    set(seconds 3000)  # some cases take ten times as long
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gtest_main)
  wobblebench_flags(${name})
  wobblebench_optimise(${name} 1)
  set(suites "${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake")
  add_custom_command(TARGET ${name} POST_BUILD BYPRODUCTS "${suites}"
    COMMAND "${CMAKE_COMMAND}" "-DPROGRAM=$<TARGET_FILE:${name}>" "-DNAME=${name}" "-DTIMEOUT=${seconds}"
      "-DNIGHTLY=${arg_NIGHTLY}" "-DSERIAL=${arg_SERIAL}" "-DTIERS=${PROJECT_SOURCE_DIR}/cmake/TestTiers.cmake" "-DOUTPUT=${suites}"
      -P "${PROJECT_SOURCE_DIR}/cmake/ListSuites.cmake" VERBATIM)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${suites}")
endfunction()
