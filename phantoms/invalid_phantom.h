// What every refusal of this room throws.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "base/options.h"

namespace wobblebench::phantoms {

/// Options or a file that no phantom can be made of; what() is one line.
class InvalidPhantom : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

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
