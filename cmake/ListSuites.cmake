# cmake -DPROGRAM=a_test -DNAME=a_test -DTIMEOUT=seconds "-DNIGHTLY=Suite;…" -DTIERS=TestTiers.cmake
#   -DOUTPUT=a_test_suites.cmake -P ListSuites.cmake
# Writes a file for CTest with a test for each suite of a GoogleTest program, labelled with the program's name and with
# its tier, which TIERS finds when CTest runs.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE list RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failed}")
endif()
string(REPLACE ";" " " list "${list}")  # of parameters, which stand behind the names
string(REPLACE "\n" ";" lines "${list}")
set(text "include([==[${TIERS}]==])\n")
set(unknown ${NIGHTLY})
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\.( |$)")
    set(suite "${CMAKE_MATCH_1}")
    set(labels "${NAME}")
    list(FIND NIGHTLY "${suite}" nightly)
    if(NOT nightly EQUAL -1)
      string(APPEND labels " nightly")
      list(REMOVE_ITEM unknown "${suite}")
    endif()
    string(APPEND text "add_test([==[${NAME}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
      "set_tests_properties([==[${NAME}.${suite}]==] PROPERTIES TIMEOUT ${TIMEOUT})\n"
      "wobblebench_tier([==[${NAME}.${suite}]==] ${labels})\n")
  endif()
endforeach()
if(unknown)
  message(FATAL_ERROR "NIGHTLY ${unknown}: no such suite of ${NAME}")
endif()
file(WRITE "${OUTPUT}" "${text}")
