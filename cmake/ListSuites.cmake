# cmake -DPROGRAM=a_test -DNAME=a_test -DTIMEOUT=seconds -DTIERS=tiers.cmake -DOUTPUT=a_test_suites.cmake
#   -P ListSuites.cmake
# Writes a file for CTest with a test for each suite of a GoogleTest program, labelled with the program's name and with
# the tier that TIERS gives the suite.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE list RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failed}")
endif()
string(REPLACE ";" " " list "${list}")  # of parameters, which stand behind the names
string(REPLACE "\n" ";" lines "${list}")
set(text "include([==[${TIERS}]==])\n")
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\.( |$)")
    set(suite "${CMAKE_MATCH_1}")
    string(APPEND text "add_test([==[${NAME}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
      "tier_labels([==[${suite}]==] labels)\n"
      "set_tests_properties([==[${NAME}.${suite}]==] PROPERTIES TIMEOUT ${TIMEOUT} LABELS \"${NAME};\${labels}\")\n")
  endif()
endforeach()
file(WRITE "${OUTPUT}" "${text}")
