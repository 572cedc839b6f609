# Writes OUTPUT, a header with VERSION and the commit that is being built. Run at every build; the file changes,
# and with it what includes it, only when the commit does.
execute_process(COMMAND git describe --always --dirty --abbrev=12 --exclude=*
  WORKING_DIRECTORY "${SOURCE_DIR}" OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
string(CONCAT text "#pragma once\n" "inline constexpr char kBuildVersion[] = \"${VERSION}\";\n"
  "inline constexpr char kBuildCommit[] = \"${commit}\";\n")
set(before "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" before)
endif()
if(NOT text STREQUAL before)
  file(WRITE "${OUTPUT}" "${text}")
endif()
