# Installs and exports the modules, so that another project can find_package(wobblebench) and link
# wobblebench::hw, wobblebench::render, …
include_guard()
include(CMakePackageConfigHelpers)

set(config_directory "${CMAKE_INSTALL_LIBDIR}/cmake/wobblebench")
install(EXPORT wobblebench-targets NAMESPACE wobblebench:: DESTINATION "${config_directory}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/wobblebenchConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake" INSTALL_DESTINATION "${config_directory}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/wobblebenchConfig.cmake"
  "${PROJECT_BINARY_DIR}/wobblebenchConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindOpenCVImgproc.cmake"
  DESTINATION "${config_directory}")
