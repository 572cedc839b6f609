// Durations of a clock as numbers.
#pragma once

#include <chrono>

namespace wobblebench {

template <class Number, class Period>
constexpr double to_milliseconds(std::chrono::duration<Number, Period> duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

template <class Number, class Period>
constexpr double to_seconds(std::chrono::duration<Number, Period> duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace wobblebench
