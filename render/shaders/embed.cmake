# cmake -DOUTPUT=file.cpp -DSHADERS="a.glsl;b.glsl" -P embed.cmake
# Writes a C++ file that defines shader_text(name), see render/gl/program.h.
set(text "#include \"render/gl/program.h\"\n\nnamespace wobblebench::render {\n\n")
string(APPEND text "std::string_view shader_text(std::string_view file) {\n")
foreach(path IN LISTS SHADERS)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" source)
  string(APPEND text "  if (file == \"${name}\") return R\"glsl(${source})glsl\";\n")
endforeach()
string(APPEND text "  return {};\n}\n\n}  // namespace wobblebench::render\n")
file(WRITE "${OUTPUT}" "${text}")
