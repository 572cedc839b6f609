// Deflated bytes, by zlib, a piece at a time.
#pragma once

#include <zlib.h>

#include <new>
#include <span>
#include <string_view>

namespace wobblebench::bench {

class Inflater {
 public:
  static constexpr int kBare = -MAX_WBITS;            ///< as in ZIP files
  static constexpr int kZlibOrGzip = MAX_WBITS + 32;  ///< as the bytes say
  static constexpr std::uint64_t kMostRatio = 1032;   ///< of what comes out to what goes in

  explicit Inflater(int window) {
    if (inflateInit2(&stream_, window) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// The next bytes, of less than 4 GB; those before must have been used up by read().
  void feed(std::string_view bytes) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
  }
  /// How many bytes of `out` were filled: fewer than all at the end, and where more must be fed.
  std::size_t read(std::span<char> out) {
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(out.size());
    if (state_ == Z_OK) state_ = inflate(&stream_, Z_NO_FLUSH);
    if (state_ == Z_BUF_ERROR) state_ = Z_OK;  // it waits for more
    return out.size() - stream_.avail_out;
  }
  bool is_damaged() const { return state_ != Z_OK && state_ != Z_STREAM_END; }
  /// All was read, and nothing that was fed is left.
  bool is_done() const { return state_ == Z_STREAM_END && stream_.avail_in == 0; }

 private:
  z_stream stream_{};
  int state_ = Z_OK;
};

}  // namespace wobblebench::bench
