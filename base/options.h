// How an options struct says what it holds. Each struct has one function
//
//   template <OptionsOf<Options> O, class Visitor>
//   void describe(O& options, Visitor& visitor);
//
// that names every field with the key, unit and range that people see. The range check here, the
// scene file and the report's resolved scene are visitors of that one description; a visitor that
// only reads is given a const object.
//
// A visitor has:
//   real(key, double& si_value, unit, min, max)   min and max in the key's unit: key mm, unit 1e-3
//   real_or_auto(key, std::optional<double>& si_value, unit, min, max)   nullopt: "auto"
//   reals(key, std::vector<double>& si_values, unit, min, max)   a list of any length
//   vec3(key, glm::dvec3& si_values, unit, min, max)             three numbers
//   integer(key, int& value, min, max)
//   seed(key, std::uint64_t& value)
//   flag(key, bool& value)
//   choice(key, Enum& value, {{"name", Enum::name}, …})
//   text(key, std::string& value)
//   texts(key, std::vector<std::string>& values)  any length
//   constant(key, std::string_view text)          follows from other fields: shown, never set
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace wobblebench {

/// As files write a value that the program chooses.
inline constexpr std::string_view kAuto = "auto";

/// `Options`, const or not: lets one describe() serve visitors that read and visitors that write.
template <class T, class Options>
concept OptionsOf = std::same_as<std::remove_const_t<T>, Options>;

/// A value that an option does not allow; what() reads "KEY = VALUE: ALLOWED".
class InvalidOption : public std::invalid_argument {
 public:
  InvalidOption(std::string_view key, std::string_view value, std::string_view allowed)
      : std::invalid_argument(std::string(key) + " = " + std::string(value) + ": " +
                              std::string(allowed)) {}
};

/// The visitor that refuses values out of range, NaN and infinities. Refusals name the key behind
/// `prefix`, "ray_casting." say.
///
/// @code
/// #include <cstdio>
/// #include "hw/probe/probe.h"
/// hw::ProbeOptions probe;
/// probe.f_number = -1;
/// try {
///   check_options(probe, "probe.");
/// } catch (const InvalidOption& error) {
///   std::puts(error.what());  // probe.f_number = -1: must be within …
/// }
/// @endcode
class OptionCheck {
 public:
  explicit OptionCheck(std::string_view prefix = "") : prefix_(prefix) {}

  void real(std::string_view key, double value, double unit, double min, double max) {
    check_range(key, value / unit, min, max);
  }
  void real_or_auto(std::string_view key,
                    const std::optional<double>& value,
                    double unit,
                    double min,
                    double max) {
    if (value) check_range(key, *value / unit, min, max);
  }
  void reals(std::string_view key,
             const std::vector<double>& values,
             double unit,
             double min,
             double max) {
    for (const double value : values) check_range(key, value / unit, min, max);
  }
  void vec3(std::string_view key, const glm::dvec3& values, double unit, double min, double max) {
    for (int i = 0; i < 3; ++i) check_range(key, values[i] / unit, min, max);
  }
  void integer(std::string_view key, int value, int min, int max) {
    check_range(key, value, min, max);
  }
  void seed(std::string_view, std::uint64_t) {}
  void flag(std::string_view, bool) {}
  void text(std::string_view, const std::string&) {}
  void texts(std::string_view, const std::vector<std::string>&) {}
  void constant(std::string_view, std::string_view) {}
  template <class Enum>
  void choice(std::string_view, Enum, std::initializer_list<std::pair<std::string_view, Enum>>) {}

 private:
  void check_range(std::string_view key, double value, double min, double max) const {
    // A unit conversion may move a limit by one rounding; a user's 160 mm must stay 160 mm.
    const double slack = 1e-12 * (std::abs(min) + std::abs(max));
    if (value >= min - slack && value <= max + slack) return;
    std::ostringstream shown, allowed;
    // Large whole numbers in full, without the last digits of a unit's conversion.
    shown.precision(12);
    allowed.precision(12);
    shown << value;
    allowed << "must be within " << min << " and " << max;
    throw InvalidOption(prefix_ + std::string(key), shown.str(), allowed.str());
  }

  std::string prefix_;
};

/// Throws InvalidOption if any described field of `options` is out of its range.
template <class Options>
void check_options(const Options& options, std::string_view prefix = "") {
  OptionCheck check(prefix);
  describe(options, check);
}

}  // namespace wobblebench
