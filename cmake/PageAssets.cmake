# What report.html holds besides its document: page.css, page.js, joined from script/, and charts.js, a bundle of Vega-Lite and its
# packages. These come from npm by a lock file, once for each state of that file, when CMake configures; a build step
# neither downloads nor fails for want of them.
include_guard()
set(WOBBLEBENCH_PAGES AUTO CACHE STRING "Charts in report.html, by packages of npm: AUTO (if npm can get them), ON or OFF")
set_property(CACHE WOBBLEBENCH_PAGES PROPERTY STRINGS AUTO ON OFF)
if(NOT WOBBLEBENCH_PAGES MATCHES "^(AUTO|ON|OFF)$")
  message(FATAL_ERROR "WOBBLEBENCH_PAGES = ${WOBBLEBENCH_PAGES}: must be AUTO, ON or OFF")
endif()

set(page_source_dir "${PROJECT_SOURCE_DIR}/bench/output/page")
# script/charts and tests/pages use the packages from here, too.
set(page_packages_dir "${PROJECT_BINARY_DIR}/page")

# npm_packages(FOLDER FILES… RESULT): copies the files, among them package.json and its lock, to FOLDER and installs the
# packages there, unless that was done for the same files. RESULT: empty, or why not.
function(npm_packages folder files result)
  find_program(NPM npm)
  if(NOT NPM)
    set(${result} "npm is not installed" PARENT_SCOPE)
    return()
  endif()
  set(state)
  foreach(file IN LISTS files)
    file(COPY "${file}" DESTINATION "${folder}")
    if(file MATCHES "package(-lock)?\\.json$")
      file(SHA256 "${file}" hash)
      string(APPEND state "${hash}\n")
    endif()
  endforeach()
  set(stamp "${folder}/installed")
  if(EXISTS "${stamp}")
    file(READ "${stamp}" installed)
  endif()
  if(NOT "${installed}" STREQUAL "${state}")
    message(STATUS "npm ci in ${folder}")
    execute_process(
      COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --fetch-retries=1
        --fetch-retry-mintimeout=1000 --fetch-timeout=30000
      WORKING_DIRECTORY "${folder}" TIMEOUT 300 RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
    if(failed)
      file(WRITE "${folder}/npm.log" "${said}")
      set(${result} "npm ci failed (${folder}/npm.log)" PARENT_SCOPE)
      return()
    endif()
    file(WRITE "${stamp}" "${state}")
  endif()
  set(${result} "" PARENT_SCOPE)
endfunction()

# bundle_charts(OUTPUT RESULT): charts.js with its packages. RESULT: empty, or why not.
function(bundle_charts output result)
  set(files package.json package-lock.json charts.js bundle.js)
  list(TRANSFORM files PREPEND "${page_source_dir}/")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  npm_packages("${page_packages_dir}" "${files}" problem)
  if(NOT problem)
    find_program(NODE NAMES node nodejs)
    execute_process(COMMAND "${NODE}" bundle.js "${output}"
      WORKING_DIRECTORY "${page_packages_dir}" RESULT_VARIABLE failed ERROR_VARIABLE problem)
    if(NOT failed)
      set(problem)
    endif()
    string(REGEX REPLACE "\n.*" "" problem "${problem}")
  endif()
  set(${result} "${problem}" PARENT_SCOPE)
endfunction()

# join_page_script(OUTPUT): page.js.
function(join_page_script output)
  set(parts dom details colours table comparison map chart start)
  list(TRANSFORM parts REPLACE "(.+)" "${page_source_dir}/script/\\1.js")
  set(script "${PROJECT_SOURCE_DIR}/cmake/JoinScripts.cmake")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${output}" "-DFILES=${parts}" -P "${script}"
    DEPENDS ${parts} "${script}"
    COMMENT "Joining the script of pages"
    VERBATIM)
endfunction()

# wobblebench_page_assets(TARGET): adds to the target what bench/output/page/page_assets.h declares.
function(wobblebench_page_assets target)
  set(page_script "${CMAKE_CURRENT_BINARY_DIR}/page.js")
  join_page_script("${page_script}")
  set(assets "${page_source_dir}/page.css" "${page_script}")
  set(charts "${page_packages_dir}/bundle/charts.js")
  file(MAKE_DIRECTORY "${page_packages_dir}/bundle")
  if(WOBBLEBENCH_PAGES STREQUAL "OFF")
    set(problem "built without charts")
  else()
    bundle_charts("${charts}" problem)
    if(NOT problem)
      list(APPEND assets "${charts}")
    elseif(WOBBLEBENCH_PAGES STREQUAL "ON")
      message(FATAL_ERROR "WOBBLEBENCH_PAGES = ON, but ${problem}")
    else()
      message(STATUS "report.html will be without charts: ${problem}")
    endif()
  endif()
  set_property(GLOBAL PROPERTY wobblebench_pages_lack "${problem}")  # for tests/pages
  set(source "${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp")
  set(script "${PROJECT_SOURCE_DIR}/cmake/EmbedText.cmake")
  add_custom_command(
    OUTPUT "${source}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${source}" "-DFILES=${assets}" -DHEADER=bench/output/page/page_assets.h
            -DNAMESPACE=bench -DFUNCTION=page_asset -DHASH_FUNCTION=page_asset_sha256 -P "${script}"
    DEPENDS ${assets} "${script}"
    COMMENT "Embedding what pages hold"
    VERBATIM)
  target_sources(${target} PRIVATE "${source}")
endfunction()
