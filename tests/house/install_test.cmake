# Installs this build into a scratch prefix, and builds a consumer and the examples against it.
# Arguments: BUILD, SOURCE (of the project), SCRATCH, RENDER_ONLY.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${out}")
  endif()
endfunction()

# build(SOURCE OPTIONS…): configures and builds the project in SCRATCH/build.
function(build source)
  file(REMOVE_RECURSE "${SCRATCH}/build")
  run(${CMAKE_COMMAND} -S "${source}" -B "${SCRATCH}/build" -G Ninja "-DCMAKE_PREFIX_PATH=${SCRATCH}/prefix" ${ARGN})
  run(${CMAKE_COMMAND} --build "${SCRATCH}/build")
endfunction()

# expect_client(WANTED LACKING REASON): find_package() of these components without these packages says this; empty: it
# finds them.
function(expect_client wanted lacking reason)
  file(REMOVE_RECURSE "${SCRATCH}/client")
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${SOURCE}/tests/house/client" -B "${SCRATCH}/client" -G Ninja
      "-DCMAKE_PREFIX_PATH=${SCRATCH}/prefix" "-DWANTED=${wanted}" "-DLACKING=${lacking}"
    RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  # CMake breaks lines.
  string(REGEX REPLACE "[ \n]+" " " out "${out}")
  string(FIND "${out}" "${reason}" found)
  if(found EQUAL -1 OR (reason AND result EQUAL 0) OR (NOT reason AND NOT result EQUAL 0))
    message(FATAL_ERROR "find_package(wobblebench COMPONENTS ${wanted}) without ${lacking}: expected \"${reason}\", got\n${out}")
  endif()
endfunction()

# The depth of `run` and of the example that renders with the installed libraries are the same bytes.
function(expect_same_depth)
  set(program "${SCRATCH}/prefix/bin/wobblebench")
  set(scene "${SOURCE}/docs/scenes/sphere.toml")
  set(recording "file=${SCRATCH}/record/recording.wbst")
  run("${program}" record "${scene}" --out "${SCRATCH}/record")
  run("${program}" run "${scene}" --board "${recording}" --out "${SCRATCH}/run")
  run("${SCRATCH}/build/render_scene" "${scene}" "${recording}" "${SCRATCH}/depth.exr")
  run(${CMAKE_COMMAND} -E compare_files "${SCRATCH}/run/depth.exr" "${SCRATCH}/depth.exr")
  run("${SCRATCH}/build/board_reader" "${SCRATCH}/record/recording.wbst")
endfunction()

file(REMOVE_RECURSE "${SCRATCH}")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${SCRATCH}/prefix")
include("${SOURCE}/cmake/PublicHeaders.cmake")
list(JOIN pipeline_headers " " pipeline_headers)
build("${SOURCE}/tests/house/consumer" "-DSHOWN_ELSEWHERE=${pipeline_headers}")
run("${SCRATCH}/build/consumer")

set(of_the_bench OpenVDB Ceres OpenCVParts OpenSSL ZLIB nlohmann_json tomlplusplus)
expect_client(hw "${of_the_bench}" "")
expect_client("hw;render" "${of_the_bench}" "")
expect_client(hw TBB "component base needs TBB, which is not here (Debian: libtbb-dev)")
expect_client(viewer "" "there is no component viewer; there are base, hw, render")

build("${SOURCE}/examples/cpp")
if(RENDER_ONLY)
  expect_client(bench "" "component phantoms is not installed (Debian: libwobblebench-bench-dev)")
else()
  expect_client(sim OpenVDB "component phantoms needs OpenVDB, which is not here (Debian: libopenvdb-dev)")
  expect_same_depth()
endif()
file(REMOVE_RECURSE "${SCRATCH}")
