// Numbers as text in decimal notation, whatever the locale.
#pragma once

#include <string>

namespace wobblebench {

/// With `digits` digits after the decimal point: "%.*f".
std::string fixed(double value, int digits);

/// With `digits` significant digits, without trailing zeros, in scientific notation where that is
/// needed: "%.*g".
std::string significant(double value, int digits);

}  // namespace wobblebench
