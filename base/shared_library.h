// Libraries that are loaded while a program runs.
#pragma once

#include <dlfcn.h>

#include <new>
#include <string>

namespace wobblebench {

/// dlopen(3) of a library that stays until the end of the program; null, with the `reason`, where
/// it cannot be loaded. Throws std::bad_alloc where the address space has no room for it, or for
/// one that it needs.
inline void* load_library(const std::string& path, std::string* reason = nullptr) {
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library != nullptr) return library;
  const char* const said = ::dlerror();  // null where another dlopen() than the system's failed
  const std::string error = said != nullptr ? said : "";
  for (const char* const no_room : {"failed to map", "cannot map", "annot allocate"})
    if (error.find(no_room) != std::string::npos) throw std::bad_alloc();
  if (reason != nullptr) *reason = error;
  return nullptr;
}

}  // namespace wobblebench
