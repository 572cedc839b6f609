// What wobblebench-import hands back: numbers in this machine's byte order, counts before lists.
// The reader trusts no count.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ios>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace wobblebench::phantoms {

/// The last word of a whole message.
inline constexpr std::uint32_t kMessageEnd = 0x444e4557;

/// Writes a message; throws std::ios_base::failure where that fails.
class MessageWriter {
 public:
  explicit MessageWriter(std::FILE* out) : out_(out) {}

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    bytes(&value, sizeof value);
  }
  void text(std::string_view value) {
    put(std::uint64_t{value.size()});
    bytes(value.data(), value.size());
  }
  template <class T>
  void list(std::span<const T> values) {
    put(std::uint64_t{values.size()});
    bytes(values.data(), values.size_bytes());
  }
  void end() {
    put(kMessageEnd);
    if (std::fflush(out_) != 0) throw std::ios_base::failure("the result cannot be written");
  }

 private:
  void bytes(const void* data, std::size_t size) {
    if (std::fwrite(data, 1, size, out_) == size) return;
    throw std::ios_base::failure("the result cannot be written");
  }
  std::FILE* out_;
};

/// Reads a message. Throws std::invalid_argument where it ends too early.
class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(get<std::uint64_t>())); }
  /// A list's bytes, whose count is at most what is left.
  template <class T>
  std::string_view list() {
    const auto count = get<std::uint64_t>();
    if (count > left_.size() / sizeof(T)) too_short();
    return take(count * sizeof(T));
  }
  bool at_end() const { return left_.empty(); }

 private:
  [[noreturn]] static void too_short() {
    throw std::invalid_argument("is damaged: what was read of it is incomplete");
  }
  std::string_view take(std::uint64_t size) {
    if (size > left_.size()) too_short();
    const std::string_view taken = left_.substr(0, size);
    left_.remove_prefix(size);
    return taken;
  }
  std::string_view left_;
};

}  // namespace wobblebench::phantoms
