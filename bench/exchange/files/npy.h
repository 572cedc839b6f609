// Arrays of NumPy, .npy, as bytes of a file.
#pragma once

#include <cstdint>
#include <functional>
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

using NumpyShape = std::vector<std::uint64_t>;
/// Is told a shape before memory is taken for it; throws to refuse it.
using CheckShape = std::function<void(const NumpyShape& shape)>;

/// What the first bytes of an .npy file say of the rest.
struct NumpyHead {
  std::string type;
  bool fortran = false;
  NumpyShape shape;
  std::uint64_t count = 0;    ///< of elements
  std::uint64_t data_at = 0;  ///< offset of the first one
  std::uint64_t size = 0;     ///< of the whole file
};

/// Most bytes of a head: NumPy itself reads no more.
inline constexpr std::size_t kMostNumpyHead = 12 + 10'000;

/// Of numbers of any real type and byte order. `bytes`: kMostNumpyHead of them, or all. Throws
/// std::invalid_argument with one line for what is no .npy file of such numbers.
NumpyHead read_npy_head(std::string_view bytes);

/// In C or Fortran order. Throws likewise where the file is not whole.
NumpyArray read_npy(std::string_view bytes, const CheckShape& check = {});

/// The header of an array in C order, in this machine's byte order: NumPy format version 1.0
/// (numpy.lib.format). Data follow at a multiple of 64 bytes. `type`: NumPy's name without the byte
/// order, "f4". No sizes: one number.
std::string npy_header(std::span<const std::uint64_t> shape, std::string_view type);

/// The bytes of an .npy file of float32, C order. The product of the shape must be the number of
/// values.
std::string npy_bytes(std::span<const std::uint64_t> shape, std::span<const float> values);

}  // namespace wobblebench::bench
