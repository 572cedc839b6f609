# OpenCV's core, imgproc and videoio alone. Debian puts OpenCVConfig.cmake into libopencv-dev, which pulls in
# every module with its dependencies; those that are used here come in packages of their own.
# Targets: opencv_core, opencv_imgproc, opencv_videoio.
include(FindPackageHandleStandardArgs)

find_path(OpenCV_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4)
find_library(OpenCV_core_LIBRARY opencv_core)
find_library(OpenCV_imgproc_LIBRARY opencv_imgproc)
find_library(OpenCV_videoio_LIBRARY opencv_videoio)
find_package_handle_standard_args(OpenCVParts
  REQUIRED_VARS OpenCV_INCLUDE_DIR OpenCV_core_LIBRARY OpenCV_imgproc_LIBRARY
    OpenCV_videoio_LIBRARY)

foreach(part core imgproc videoio)
  if(OpenCVParts_FOUND AND NOT TARGET opencv_${part})
    add_library(opencv_${part} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(opencv_${part} PROPERTIES
      IMPORTED_LOCATION "${OpenCV_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIR}")
  endif()
endforeach()
