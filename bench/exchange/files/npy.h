// Arrays of NumPy, .npy, as bytes of a file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

struct NumpyArray {
  std::string type;  ///< NumPy's name, as "<f4"
  std::vector<std::uint64_t> shape;
  std::vector<double> values;  ///< in C order

  bool is_integer() const { return type.find_first_of("iub") != std::string::npos; }
};

/// Numbers of any real type and byte order, in C or Fortran order. Throws std::invalid_argument
/// with one line for what is no whole .npy file of such numbers.
NumpyArray read_npy(std::string_view bytes);

/// The header of an array in C order, in this machine's byte order: NumPy format version 1.0
/// (numpy.lib.format). Data follow at a multiple of 64 bytes. `type`: NumPy's name without the byte
/// order, "f4".
std::string npy_header(std::span<const std::uint64_t> shape, std::string_view type);

/// The bytes of an .npy file of float32, C order. The product of the shape must be the number of
/// values.
std::string npy_bytes(std::span<const std::uint64_t> shape, std::span<const float> values);

}  // namespace wobblebench::bench
