# Which tests run when, from tests/seconds.txt: `ctest -L quick` is every test that is not in it, `-L full` every test
# but the nightly ones, what script/test runs, and `-L nightly` what .ci/nightly runs besides. CMake reads this file for
# tests that are declared by add_test, and CTest, at each run, for suites of GoogleTest.
set(wobblebench_seconds_file "${CMAKE_CURRENT_LIST_DIR}/../tests/seconds.txt")
file(STRINGS "${wobblebench_seconds_file}" wobblebench_lines REGEX "^[^# ]+ [0-9.]+$")
foreach(line IN LISTS wobblebench_lines)
  string(REGEX MATCH "^([^ ]+) (.+)$" line "${line}")
  set("seconds_of_${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}")
endforeach()

# wobblebench_tier(TEST [LABELS…]): gives a test the labels and that of its tier, unless `nightly` is one of them. COST:
# a parallel run starts the longest first, also where CTest has no record of earlier runs.
function(wobblebench_tier test)
  set(labels ${ARGN})
  list(FIND labels nightly nightly)
  if(nightly EQUAL -1)
    list(APPEND labels full)
    if(NOT DEFINED "seconds_of_${test}")
      list(APPEND labels quick)
    endif()
  endif()
  set(cost 0)
  if(DEFINED "seconds_of_${test}")
    set(cost "${seconds_of_${test}}")
  endif()
  set_tests_properties("${test}" PROPERTIES LABELS "${labels}" COST ${cost})
endfunction()

# wobblebench_skipped(TEST REASON [LABELS…]): in the place of a test for which something is absent, one that says so in
# GoogleTest's words, which script/test-skips looks for.
function(wobblebench_skipped test reason)
  add_test(NAME ${test} COMMAND ${CMAKE_COMMAND} -E echo "[  SKIPPED ] ${test}: ${reason} (0 ms)")
  set_tests_properties(${test} PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED")
  wobblebench_tier(${test} ${ARGN})
endfunction()
