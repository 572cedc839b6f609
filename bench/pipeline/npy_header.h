// The header of an array in a file, as NumPy reads it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace wobblebench::bench {

/// Of an array of complex64 in C order, in this machine's byte order: NumPy format version 1.0
/// (numpy.lib.format). Data follow at a multiple of 64 bytes.
std::string npy_header(std::span<const std::uint64_t> shape);

}  // namespace wobblebench::bench
