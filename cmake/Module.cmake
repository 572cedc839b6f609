# How this project builds a module and a program: one place for flags, aliases and include paths.
include_guard()
include(GNUInstallDirs)

# Flags of every target of ours. Contraction is off so that results match across machines; a designated
# initialiser that names only what differs from the defaults is how we write options.
function(wobblebench_flags target)
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

# Reading headers is three quarters of a sanitizer's build: the heavy ones are read once a target, and in the
# targets that link it. No other build, so that none is missing where it is used.
function(wobblebench_precompile target)
  if(WOBBLEBENCH_SANITIZE)
    target_precompile_headers(${target} PUBLIC ${ARGN})
  endif()
endfunction()

# wobblebench_precompile_for(TARGET "a.cpp;…" HEADER…): in every build, parses the headers once for these
# sources of the target, which include them, and leaves its other sources alone.
function(wobblebench_precompile_for target users)
  get_target_property(others ${target} SOURCES)
  list(REMOVE_ITEM others ${users})
  set_source_files_properties(${others} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  target_precompile_headers(${target} PRIVATE ${ARGN})
endfunction()

# wobblebench_module(NAME SOURCES a.cpp … PUBLIC lib … PRIVATE lib …)
# A static library `wobblebench_NAME`, alias `wobblebench::NAME`, whose headers are included as
# "FOLDER/header.h", FOLDER being where it is called.
function(wobblebench_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;PUBLIC;PRIVATE")
  set(target wobblebench_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(wobblebench::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/wobblebench>")
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  wobblebench_flags(${target})
  install(TARGETS ${target} EXPORT wobblebench-targets)
  file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
  install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/wobblebench/${folder}" FILES_MATCHING PATTERN "*.h")
endfunction()

# wobblebench_test(NAME SOURCES a_test.cpp … LIBS lib …): one GoogleTest program; each case is a CTest test.
# A sanitizer makes some cases ten times as long.
function(wobblebench_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBS")
  set(seconds 600)
  if(WOBBLEBENCH_SANITIZE)
    set(seconds 3000)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gtest_main)
  wobblebench_flags(${name})
  wobblebench_precompile(${name} <gtest/gtest.h>)
  gtest_discover_tests(${name} PROPERTIES TIMEOUT ${seconds} LABELS ${name} DISCOVERY_TIMEOUT 60)
endfunction()
