// Libraries of ours that are loaded when they are first needed, because of what they bring.
#pragma once

#include <string>

namespace wobblebench::bench {

/// The function `symbol` of the library "libNAME.so": the one beside the program or installed with
/// it, else the one that was built. Throws std::runtime_error "WHAT: reasons" where none can be
/// loaded. The library stays loaded.
void* function_of_library(const std::string& name, const char* symbol, const std::string& what);

}  // namespace wobblebench::bench
