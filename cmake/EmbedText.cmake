# cmake -DOUTPUT=file.cpp -DFILES="a.glsl;b.glsl" -DHEADER=room/declares.h -DNAMESPACE=room
#       -DFUNCTION=text_of [-DHASH_FUNCTION=sha256_of] -P EmbedText.cmake
# Writes a C++ file that defines wobblebench::NAMESPACE::FUNCTION(file name), as HEADER declares it: the
# file's text, empty for other names; and HASH_FUNCTION, its SHA-256 in hexadecimal digits.
set(texts)
set(hashes)
foreach(path IN LISTS FILES)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" source)
  file(SHA256 "${path}" hash)
  string(APPEND texts "  if (file == \"${name}\") return R\"embedded(${source})embedded\";\n")
  string(APPEND hashes "  if (file == \"${name}\") return \"${hash}\";\n")
endforeach()
set(text "#include \"${HEADER}\"\n\nnamespace wobblebench::${NAMESPACE} {\n\n")
string(APPEND text "std::string_view ${FUNCTION}(std::string_view file) {\n${texts}  return {};\n}\n\n")
if(HASH_FUNCTION)
  string(APPEND text "std::string_view ${HASH_FUNCTION}(std::string_view file) {\n${hashes}  return {};\n}\n\n")
endif()
file(WRITE "${OUTPUT}" "${text}}  // namespace wobblebench::${NAMESPACE}\n")
