# Installs and exports the modules, so that another project can find_package(wobblebench), link wobblebench::hw,
# wobblebench::render, …, and include "wobblebench/hw/board/board.h".
include_guard()
include(CMakePackageConfigHelpers)
include(PublicHeaders)

install(CODE "
  set(WOBBLEBENCH_HEADERS \"${public_headers}\")
  set(WOBBLEBENCH_SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
  set(WOBBLEBENCH_INCLUDE_DIR \"${CMAKE_INSTALL_INCLUDEDIR}\")")
install(SCRIPT "${CMAKE_CURRENT_LIST_DIR}/InstallHeaders.cmake")

set(config_directory "${CMAKE_INSTALL_LIBDIR}/cmake/wobblebench")
install(EXPORT wobblebench-targets NAMESPACE wobblebench:: DESTINATION "${config_directory}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/wobblebenchConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake" INSTALL_DESTINATION "${config_directory}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake"
  "${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindOpenCVParts.cmake"
  DESTINATION "${config_directory}")
