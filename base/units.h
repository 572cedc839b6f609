// Units and constants. Inside the project everything is in metres, seconds, hertz and radians;
// files and the command line speak mm, deg and MHz, with the unit in the key.
#pragma once

#include <numbers>

namespace wobblebench {

inline constexpr double kPi = std::numbers::pi;

/// Multiply a value in the named unit by its constant to get the SI value; divide to go back.
inline constexpr double kMillimetre = 1e-3;
inline constexpr double kDegree = kPi / 180.0;
inline constexpr double kMegahertz = 1e6;
inline constexpr double kMillisecond = 1e-3;
inline constexpr double kMicrosecond = 1e-6;

}  // namespace wobblebench
