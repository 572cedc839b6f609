# cmake -DPROGRAM=a_test -DNAME=a_test -DTIMEOUT=seconds "-DNIGHTLY=Suite;…" "-DSERIAL=Suite;…" -DTIERS=TestTiers.cmake
#   -DOUTPUT=a_test_suites.cmake -P ListSuites.cmake
# Writes a file for CTest with a test for each suite of a GoogleTest program, labelled with the program's name and with
# its tier, which TIERS finds when CTest runs. Those of SERIAL run alone.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE list RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failed}")
endif()
string(REPLACE ";" " " list "${list}")  # of parameters, which stand behind the names
string(REPLACE "\n" ";" lines "${list}")
set(text "include([==[${TIERS}]==])\n")
set(unknown ${NIGHTLY} ${SERIAL})
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\.( |$)")
    set(suite "${CMAKE_MATCH_1}")
    set(labels "${NAME}")
    list(FIND NIGHTLY "${suite}" nightly)
    if(NOT nightly EQUAL -1)
      string(APPEND labels " nightly")
    endif()
    set(properties "TIMEOUT ${TIMEOUT}")
    list(FIND SERIAL "${suite}" serial)
    if(NOT serial EQUAL -1)
      string(APPEND properties " RUN_SERIAL TRUE")
    endif()
    list(REMOVE_ITEM unknown "${suite}")
    string(APPEND text "add_test([==[${NAME}.${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
      "set_tests_properties([==[${NAME}.${suite}]==] PROPERTIES ${properties})\n"
      "wobblebench_tier([==[${NAME}.${suite}]==] ${labels})\n")
  endif()
endforeach()
if(unknown)
  message(FATAL_ERROR "NIGHTLY or SERIAL ${unknown}: no such suite of ${NAME}")
endif()
file(WRITE "${OUTPUT}" "${text}")
