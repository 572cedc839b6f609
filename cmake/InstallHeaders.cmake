# Run at install time, with WOBBLEBENCH_HEADERS, WOBBLEBENCH_SOURCE_DIR and WOBBLEBENCH_INCLUDE_DIR set. Our
# sources include "hw/board/board.h"; in what is installed it is "wobblebench/hw/board/board.h".
foreach(header IN LISTS WOBBLEBENCH_HEADERS)
  file(READ "${WOBBLEBENCH_SOURCE_DIR}/${header}" text)
  string(REGEX REPLACE "#include \"(base|hw|phantoms|sim|render|bench)/" "#include \"wobblebench/\\1/" text "${text}")
  file(WRITE "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${WOBBLEBENCH_INCLUDE_DIR}/wobblebench/${header}" "${text}")
endforeach()
