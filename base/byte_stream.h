// A blob of bytes, written and read value by value, in this machine's byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace wobblebench {

/// Bytes that do not hold what is read from them.
class DamagedBytes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Types without padding: every byte of theirs is written.
template <class T>
concept PlainBytes = std::is_trivially_copyable_v<T> &&
    (std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);

class ByteWriter {
 public:
  template <PlainBytes T>
  void value(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  /// Their number, then the values.
  template <PlainBytes T>
  void values(std::span<const T> values) {
    value(std::uint64_t{values.size()});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  void text(std::string_view text) { values(std::span<const char>(text)); }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Checks each length against what is left before it allocates. Its methods throw DamagedBytes.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <PlainBytes T>
  T value() {
    T value;
    std::memcpy(&value, piece(1, sizeof value).data(), sizeof value);
    return value;
  }
  template <PlainBytes T>
  std::vector<T> values() {
    const std::string_view bytes = piece(value<std::uint64_t>(), sizeof(T));
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  /// The bytes of values, not copied; they may be aligned to nothing.
  template <PlainBytes T>
  std::string_view bytes_of() {
    return piece(value<std::uint64_t>(), sizeof(T));
  }
  std::string text() { return std::string(bytes_of<char>()); }

  void expect_end() const {
    if (!rest_.empty()) throw DamagedBytes("bytes are left over");
  }

 private:
  std::string_view piece(std::uint64_t count, std::size_t size) {
    if (count > rest_.size() / size) throw DamagedBytes("bytes are missing");
    const std::string_view taken = rest_.substr(0, count * size);
    rest_.remove_prefix(taken.size());
    return taken;
  }

  std::string_view rest_;
};

/// Throws DamagedBytes, saying what is wrong, unless `holds`.
inline void expect_bytes(bool holds, const char* what) {
  if (!holds) throw DamagedBytes(what);
}

}  // namespace wobblebench
