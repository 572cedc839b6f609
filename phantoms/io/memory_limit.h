// Most memory that importing a phantom may take.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace wobblebench::phantoms {

inline constexpr double kMostBytes = 4e9;

/// Throws std::invalid_argument "would take about … of memory …" for more than kMostBytes.
inline void check_bytes(double bytes, const std::string& advice) {
  if (bytes <= kMostBytes) return;
  std::ostringstream reason;
  reason.precision(3);
  reason << "would take about " << bytes / 1e9 << " GB of memory; at most " << kMostBytes / 1e9
         << " GB are allowed" << advice;
  throw std::invalid_argument(reason.str());
}

}  // namespace wobblebench::phantoms
