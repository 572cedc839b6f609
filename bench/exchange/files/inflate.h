// Deflated bytes, by zlib.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace wobblebench::bench {

inline constexpr int kBareDeflate = -MAX_WBITS;     ///< as in ZIP files
inline constexpr int kZlibOrGzip = MAX_WBITS + 32;  ///< as the bytes say

/// The first `size` bytes of what was deflated; `whole`: it has no more. Throws
/// std::invalid_argument, before memory is taken for more than zlib can make of the bytes.
inline std::string inflated(std::string_view stored, std::uint64_t size, int window, bool whole) {
  constexpr std::uint64_t kMostRatio = 1032, kMost = std::numeric_limits<uInt>::max();
  if (size / kMostRatio > stored.size() || size > kMost || stored.size() > kMost) {
    throw std::invalid_argument("cannot be " + std::to_string(size) + " bytes");
  }
  std::string bytes(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, window) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stored.data()));
  stream.avail_in = static_cast<uInt>(stored.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size);
  const int state = inflate(&stream, whole ? Z_FINISH : Z_SYNC_FLUSH);
  inflateEnd(&stream);
  const bool ended = state == Z_STREAM_END && stream.avail_in == 0;
  if (stream.avail_out == 0 && (ended || !whole)) return bytes;
  throw std::invalid_argument("cannot be decompressed to " + std::to_string(size) + " bytes");
}

}  // namespace wobblebench::bench
