// The visitor that checks a described options struct (the phantoms room stands alone, so it brings
// its own) and the one form of its refusals.
#pragma once

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "phantoms/invalid_phantom.h"

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

/// Refuses values out of range, NaN, infinities, and lists of the wrong length.
class RangeCheck {
 public:
  void text(const char*, const std::string&) {}
  void texts(const char*, const std::vector<std::string>&) {}
  void flag(const char*, const bool&) {}
  template <class Enum>
  void choice(const char*, const Enum&, std::initializer_list<std::pair<std::string_view, Enum>>) {}
  void real(const char* key, double value_si, double unit, double min, double max) {
    const double value = value_si / unit;
    const double rounding = 1e-12 * (std::abs(min) + std::abs(max));
    if (value >= min - rounding && value <= max + rounding) return;
    std::ostringstream allowed;
    allowed << "must be within " << min << " and " << max;
    throw refusal(key, value, allowed.str());
  }
  void reals(const char* key,
             const std::vector<double>& values_si,
             double unit,
             double min,
             double max,
             std::size_t count) {
    if (count != 0 && values_si.size() != count) {
      throw refusal(key,
                    std::to_string(values_si.size()) + " numbers",
                    "takes " + std::to_string(count) + " numbers");
    }
    for (const double value : values_si) real(key, value, unit, min, max);
  }
};

/// Throws InvalidPhantom if any described field of `options` is out of its range.
template <class Options>
void check_ranges(const Options& options) {
  Options copy = options;
  RangeCheck check;
  describe(copy, check);
}

}  // namespace wobblebench::phantoms
