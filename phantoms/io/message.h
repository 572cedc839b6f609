// What wobblebench-import and its parent agree on: limits, and the message that it makes of a file.
// Numbers are in this machine's byte order, counts come before lists. The parent trusts no count.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ios>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace wobblebench::phantoms {

/// Most memory that a phantom from a file may take.
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

/// Most address space of wobblebench-import: a grid of kMostBytes, and what reading it takes.
inline constexpr double kMostImportBytes = 6e9;

/// Most processor time, s, for a file of this size: far above what a sound file takes.
constexpr unsigned long most_import_seconds(unsigned long file_bytes) {
  return 20 + file_bytes / 1'000'000;
}

/// Most time on the wall: beside others, of a reader that is at work.
inline constexpr unsigned long kWallPerProcessorTime = 4;

/// The descriptor that wobblebench-import writes its message to.
inline constexpr int kImportDescriptor = 3;

/// First words of messages.
inline constexpr std::uint32_t kImportResult = 0x54524557, kImportRefusal = 0x46524557;
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

// The message of a .vdb: metadata entries until VdbMetadata::end, each a type, a key and a value;
// then grids until VdbContents::end, each with name, value type and class, and for a grid of floats
// or doubles on a lattice its matrix (16 doubles, row by row), background, tiles until
// kNoMoreTiles, and leaves.

enum class VdbMetadata : std::uint32_t { end, text, number, integer, flag, vector };
enum class VdbContents : std::uint32_t { end, name_alone, distances };

/// One value for a cube of voxels: a tile of OpenVDB's tree.
struct VdbTile {
  std::array<std::int32_t, 3> low;  ///< least index of its voxels
  std::int32_t level;               ///< 1: 8 voxels a side, 2: 128, 3: 4096
  std::int32_t active;
  float value;
};
inline constexpr std::int32_t kNoMoreTiles = -1;

struct VdbLeaf {
  static constexpr std::uint32_t kVoxels = 512;
  std::array<std::int32_t, 3> low;
  std::array<float, kVoxels> values;
  std::array<std::uint64_t, kVoxels / 64> active;
};

}  // namespace wobblebench::phantoms
