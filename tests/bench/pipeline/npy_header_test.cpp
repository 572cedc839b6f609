// Headers of arrays, byte for byte those that NumPy 1.24 writes
// (numpy.lib.format.write_array_header_1_0).
#include "bench/exchange/files/npy.h"

#include <gtest/gtest.h>

#include <array>

namespace wobblebench::bench {
namespace {

/// Version 1.0 and a header of 0x76 bytes, in a line that ends at a multiple of 64.
std::string of_numpy(const std::string& dictionary) {
  std::string header("\x93NUMPY\x01\x00\x76\x00", 10);
  header += dictionary;
  header.append(127 - header.size(), ' ');
  return header + '\n';
}

TEST(NpyHeader, IsThatOfNumPy) {
  const std::array<std::uint64_t, 4> volumes{2, 9, 16, 1024};
  EXPECT_EQ(npy_header(volumes, "c8"),
            of_numpy("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 9, 16, 1024), }"));
  const std::array<std::uint64_t, 4> largest{1000, 1024, 1024, 90112};
  EXPECT_EQ(
      npy_header(largest, "c8"),
      of_numpy("{'descr': '<c8', 'fortran_order': False, 'shape': (1000, 1024, 1024, 90112), }"));
  const std::array<std::uint64_t, 1> row{7};
  EXPECT_EQ(npy_header(row, "c8"),
            of_numpy("{'descr': '<c8', 'fortran_order': False, 'shape': (7,), }"));
}

}  // namespace
}  // namespace wobblebench::bench
