// Numbers among bytes, and parts of a file of NumPy's that may end too early.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace wobblebench::bench::numpy {

inline constexpr std::uint32_t kIn64 = 0xffffffff;  ///< in a ZIP: the number is in the ZIP64 field
inline constexpr std::uint64_t kMostBytes = 4'000'000'000;  ///< of an array

inline std::invalid_argument unreadable(const std::string& what) {
  return std::invalid_argument("is no readable NumPy file: " + what);
}

/// A number of little-endian bytes at an offset. Throws where the bytes end before.
template <class T>
T number_at(std::string_view bytes, std::uint64_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) {
    throw unreadable("it ends too early");
  }
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// A number where it stands; `swap`: its bytes are in the other order.
template <class T>
double value_of(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  std::copy_n(bytes, sizeof(T), raw);
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

inline std::string_view part_of(std::string_view bytes, std::uint64_t offset, std::uint64_t count) {
  if (offset > bytes.size() || bytes.size() - offset < count) {
    throw unreadable("it ends too early");
  }
  return bytes.substr(offset, count);
}

}  // namespace wobblebench::bench::numpy
