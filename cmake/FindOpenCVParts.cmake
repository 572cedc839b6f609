# OpenCV's core and imgproc alone. Debian puts OpenCVConfig.cmake into libopencv-dev, which pulls in
# every module with its dependencies; the two that are used here come in packages of their own.
# Targets: opencv_core, opencv_imgproc.
include(FindPackageHandleStandardArgs)

find_path(OpenCV_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4)
find_library(OpenCV_core_LIBRARY opencv_core)
find_library(OpenCV_imgproc_LIBRARY opencv_imgproc)
find_package_handle_standard_args(OpenCVImgproc
  REQUIRED_VARS OpenCV_INCLUDE_DIR OpenCV_core_LIBRARY OpenCV_imgproc_LIBRARY)

foreach(part core imgproc)
  if(OpenCVImgproc_FOUND AND NOT TARGET opencv_${part})
    add_library(opencv_${part} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(opencv_${part} PROPERTIES
      IMPORTED_LOCATION "${OpenCV_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIR}")
  endif()
endforeach()
