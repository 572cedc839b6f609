// Arrays as NumPy reads them: an .npz file is a ZIP archive of .npy files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/exchange/files/out_file.h"

namespace wobblebench::bench {

/// Writes one array after the other, uncompressed, in C order. Sizes are written as ZIP64 has them,
/// so that an array may be larger than 4 GB, and an array may be written in pieces. Throws
/// std::runtime_error as OutFile does.
class NpzFile {
 public:
  explicit NpzFile(std::filesystem::path path) : file_(std::move(path)) {}

  /// `descr`: NumPy's name of the type, "<f4".
  void begin(const std::string& name,
             const std::string& descr,
             const std::vector<std::uint64_t>& shape);
  void append(std::string_view bytes);
  /// Throws std::logic_error unless the pieces fill the shape.
  void end();

  template <class T>
  void array(const std::string& name,
             const std::vector<std::uint64_t>& shape,
             std::span<const T> values);
  void number(const std::string& name, double value) {
    array<double>(name, {}, std::span(&value, 1));
  }
  /// UTF-8 texts, as NumPy's "U".
  void texts(const std::string& name, const std::vector<std::string>& values);

  /// Writes the directory of the archive.
  void finish();

 private:
  struct Entry {
    std::string name;
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    std::uint32_t crc = 0;
  };

  OutFile file_;
  std::vector<Entry> entries_;
  std::uint64_t expected_ = 0;  ///< bytes of the array under way
};

template <class T>
inline constexpr const char* kNumpyType = nullptr;
template <>
inline constexpr const char* kNumpyType<float> = "<f4";
template <>
inline constexpr const char* kNumpyType<double> = "<f8";
template <>
inline constexpr const char* kNumpyType<std::uint8_t> = "|u1";
template <>
inline constexpr const char* kNumpyType<std::int64_t> = "<i8";

template <class T>
void NpzFile::array(const std::string& name,
                    const std::vector<std::uint64_t>& shape,
                    std::span<const T> values) {
  static_assert(kNumpyType<T> != nullptr);
  begin(name, kNumpyType<T>, shape);
  const auto bytes = std::as_bytes(values);
  append({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  end();
}

}  // namespace wobblebench::bench
