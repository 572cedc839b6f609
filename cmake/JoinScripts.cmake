# cmake -DOUTPUT=page.js -DFILES="dom.js;…" -P JoinScripts.cmake
# Writes one script of several, in a scope of its own and in strict mode.
set(text "'use strict';\n{\n")
foreach(path IN LISTS FILES)
  file(READ "${path}" part)
  string(APPEND text "${part}\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}}\n")
