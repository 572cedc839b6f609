# Debian packages of what is installed: `cpack --config build/NAME/CPackConfig.cmake`, or script/packages.
#
#   wobblebench                programs, man pages, completion for bash
#   wobblebench-runtime        what programs, module and libraries load or start: encoders of pictures, reader of imported files
#   python3-wobblebench        import wobblebench
#   libwobblebench-dev         components base, hw, render
#   libwobblebench-bench-dev   components tables, phantoms, sim, bench
#   wobblebench-doc            docs and examples
include_guard()
find_package(Python3 QUIET COMPONENTS Interpreter)

# Man pages and completion.
if(Python3_Interpreter_FOUND AND NOT WOBBLEBENCH_RENDER_ONLY)
  set(manuals "${PROJECT_BINARY_DIR}/manuals")
  set(stub "${PROJECT_SOURCE_DIR}/bench/python/wobblebench/__init__.pyi")
  add_custom_command(OUTPUT "${manuals}/completion"
    COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/script/man-pages" "${manuals}"
    DEPENDS "${PROJECT_SOURCE_DIR}/script/man-pages" "${PROJECT_SOURCE_DIR}/docs/commands.md" "${stub}"
    COMMENT "Writing man pages and completion"
    VERBATIM)
  add_custom_target(wobblebench_manuals ALL DEPENDS "${manuals}/completion")
  install(DIRECTORY "${manuals}/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program FILES_MATCHING PATTERN "*.1.gz")
  install(FILES "${manuals}/completion" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
    RENAME wobblebench COMPONENT program)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" "${PROJECT_SOURCE_DIR}/examples"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/wobblebench" COMPONENT doc)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${PROJECT_SOURCE_DIR}/LICENSE"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/wobblebench" COMPONENT doc)

if(NOT PROJECT_IS_TOP_LEVEL OR WOBBLEBENCH_RENDER_ONLY)
  return()
endif()

# package(COMPONENT NAME DEPENDS SUMMARY)
macro(package component name depends summary)
  string(TOUPPER ${component} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION science)
endmacro()

set(same "(= ${PROJECT_VERSION})")
set(CPACK_COMPONENTS_ALL)
# The drivers of OpenGL are opened at run time, where no tool sees it.
package(runtime wobblebench-runtime "libosmesa6 | libegl1, libgl1-mesa-dri"
  "Encoders of pictures and videos, and the reader of imported files")
package(program wobblebench "wobblebench-runtime ${same}"
  "A simulation-driven test bench for 4D ultrasound surface rendering")
package(dev libwobblebench-dev "libglm-dev, libtbb-dev"
  "Libraries that read a board and render: find_package(wobblebench COMPONENTS hw render)")
string(CONCAT bench_needs "libwobblebench-dev ${same}, wobblebench-runtime ${same}, libopenvdb-dev, libblosc-dev, "
  "libboost-iostreams-dev, libimath-dev, nlohmann-json3-dev, libceres-dev, libssl-dev, zlib1g-dev, libopencv-core-dev, "
  "libopencv-imgproc-dev, libopencv-videoio-dev, libtomlplusplus-dev, libfuse3-dev")
package(bench-dev libwobblebench-bench-dev "${bench_needs}"
  "Libraries of scenes, phantoms, simulator and measures: find_package(wobblebench COMPONENTS bench)")
package(doc wobblebench-doc "" "Documentation and examples of wobblebench")
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
if(wobblebench_python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(CONCAT python_needs "wobblebench-runtime ${same}, python3-numpy, "
    "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
  package(python python3-wobblebench "${python_needs}" "The Python module of wobblebench")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME wobblebench)
set(CPACK_PACKAGE_VENDOR wobblebench)
set(CPACK_PACKAGE_CONTACT "The authors of wobblebench <wobblebench@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
include(CPack)
