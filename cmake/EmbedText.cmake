# cmake -DOUTPUT=file.cpp -DFILES="a.glsl;b.glsl" -DHEADER=room/declares.h -DNAMESPACE=room
#       -DFUNCTION=text_of -P EmbedText.cmake
# Writes a C++ file that defines wobblebench::NAMESPACE::FUNCTION(file name), as HEADER declares it: the
# file's text, empty for other names.
set(text "#include \"${HEADER}\"\n\nnamespace wobblebench::${NAMESPACE} {\n\n")
string(APPEND text "std::string_view ${FUNCTION}(std::string_view file) {\n")
foreach(path IN LISTS FILES)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" source)
  string(APPEND text "  if (file == \"${name}\") return R\"embedded(${source})embedded\";\n")
endforeach()
string(APPEND text "  return {};\n}\n\n}  // namespace wobblebench::${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${text}")
