// How an options struct says what it holds. Each struct has one function
//
//   template <class Visitor> void describe(Options& options, Visitor& visitor);
//
// that names every field with the key, unit and range that people see. Validation here, the scene
// file and the report's resolved scene are all visitors of that one description.
//
// A visitor has:
//   real(key, double& si_value, unit, min, max)   min and max in the key's unit: key mm, unit 1e-3
//   integer(key, int& value, min, max)
//   seed(key, std::uint64_t& value)
//   flag(key, bool& value)
//   choice(key, Enum& value, {{"name", Enum::name}, …})
//   text(key, std::string& value)
//   texts(key, std::vector<std::string>& values)  any length
//   constant(key, std::string_view text)          follows from other fields: shown, never set
//   reals(key, std::vector<double>& si_values, unit, min, max, count)   count 0: any length
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wobblebench::hw {

/// A value that an option does not allow; what() reads "KEY = VALUE: ALLOWED".
class InvalidOption : public std::invalid_argument {
 public:
  InvalidOption(std::string_view key, std::string_view value, std::string_view allowed)
      : std::invalid_argument(std::string(key) + " = " + std::string(value) + ": " +
                              std::string(allowed)) {}
};

/// The visitor that refuses values out of range, NaN and infinities.
class OptionCheck {
 public:
  void real(std::string_view key, const double& value, double unit, double min, double max) {
    check_range(key, value / unit, min, max);
  }
  void integer(std::string_view key, const int& value, int min, int max) {
    check_range(key, value, min, max);
  }
  void seed(std::string_view, const std::uint64_t&) {}
  void flag(std::string_view, const bool&) {}
  void text(std::string_view, const std::string&) {}
  void texts(std::string_view, const std::vector<std::string>&) {}
  void constant(std::string_view, std::string_view) {}
  template <class Enum>
  void choice(std::string_view,
              const Enum&,
              std::initializer_list<std::pair<std::string_view, Enum>>) {}
  void reals(std::string_view key,
             const std::vector<double>& values,
             double unit,
             double min,
             double max,
             std::size_t count) {
    if (count != 0 && values.size() != count) {
      throw InvalidOption(key,
                          std::to_string(values.size()) + " numbers",
                          "takes " + std::to_string(count) + " numbers");
    }
    for (double value : values) check_range(key, value / unit, min, max);
  }

 private:
  static void check_range(std::string_view key, double value, double min, double max) {
    // A unit conversion may move a limit by one rounding; a user's 160 mm must stay 160 mm.
    const double slack = 1e-12 * (std::abs(min) + std::abs(max));
    if (value >= min - slack && value <= max + slack) return;
    std::ostringstream shown, allowed;
    // Large whole numbers in full, without the last digits of a unit's conversion.
    shown.precision(12);
    allowed.precision(12);
    shown << value;
    allowed << "must be within " << min << " and " << max;
    throw InvalidOption(key, shown.str(), allowed.str());
  }
};

/// Throws InvalidOption if any described field of `options` is out of its range.
template <class Options>
void check_options(const Options& options) {
  Options copy = options;
  OptionCheck check;
  describe(copy, check);
}

}  // namespace wobblebench::hw
