# Installs and exports the modules, so that another project can find_package(wobblebench COMPONENTS hw render …), link
# wobblebench::hw, wobblebench::render, …, and include "wobblebench/hw/board/board.h".
include_guard()
include(CMakePackageConfigHelpers)
include(PublicHeaders)

# wobblebench_install_headers(PACKAGE HEADERS…)
function(wobblebench_install_headers package)
  install(CODE "
    set(WOBBLEBENCH_HEADERS \"${ARGN}\")
    set(WOBBLEBENCH_SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
    set(WOBBLEBENCH_INCLUDE_DIR \"${CMAKE_INSTALL_INCLUDEDIR}\")
    include(\"${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake\")" COMPONENT ${package})
endfunction()
wobblebench_install_headers(dev ${dev_headers})

set(config_directory "${CMAKE_INSTALL_LIBDIR}/cmake/wobblebench")
foreach(component IN ITEMS base hw render)
  install(EXPORT wobblebench-${component} NAMESPACE wobblebench:: DESTINATION "${config_directory}" COMPONENT dev)
endforeach()
set(bench_components tables)
if(NOT WOBBLEBENCH_RENDER_ONLY)
  list(APPEND bench_components phantoms sim bench)
  wobblebench_install_headers(bench-dev ${bench_headers} ${pipeline_headers})
endif()
foreach(component IN LISTS bench_components)
  install(EXPORT wobblebench-${component} NAMESPACE wobblebench:: DESTINATION "${config_directory}" COMPONENT bench-dev)
endforeach()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/wobblebenchConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake" INSTALL_DESTINATION "${config_directory}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake"
  "${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindOpenCVParts.cmake"
  DESTINATION "${config_directory}" COMPONENT dev)
