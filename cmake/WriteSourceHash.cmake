# Writes OUTPUT, a header with NAME, a SHA-256 of the sources FILES and of what
# compiles them: whatever a cache kept of another build is not taken. Run when one of them changes.
set(all "${COMPILER}")
foreach(file IN LISTS FILES)
  file(SHA256 "${SOURCE_DIR}/${file}" hash)
  string(APPEND all "\n${file} ${hash}")
endforeach()
string(SHA256 hash "${all}")
file(WRITE "${OUTPUT}" "#pragma once\ninline constexpr char ${NAME}[] = \"${hash}\";\n")
