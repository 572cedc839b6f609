// Construction of InvalidPhantom, and the range check of options.
#pragma once

#include <sstream>
#include <string>

#include "base/options.h"
#include "phantoms/options.h"

namespace wobblebench::phantoms {

/// "KEY = VALUE: ALLOWED".
inline InvalidPhantom refusal(const std::string& key,
                              const std::string& value,
                              const std::string& allowed) {
  return InvalidPhantom(key + " = " + value + ": " + allowed);
}

inline InvalidPhantom refusal(const std::string& key, double value, const std::string& allowed) {
  std::ostringstream shown;
  shown << value;
  return refusal(key, shown.str(), allowed);
}

inline std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

/// Throws InvalidPhantom if any described field of `options` is out of its range.
template <class Options>
void check_ranges(const Options& options) {
  try {
    check_options(options);
  } catch (const InvalidOption& error) {
    throw InvalidPhantom(error.what());
  }
}

}  // namespace wobblebench::phantoms
