#include "bench/exchange/files/npz_reader.h"

#include <zlib.h>

#include <algorithm>
#include <new>

#include "bench/exchange/files/numpy_parts.h"

namespace wobblebench::bench {

using namespace numpy;

namespace {

constexpr std::uint32_t kEntry = 0x02014b50, kLocal = 0x04034b50;
constexpr std::uint32_t kEnd64 = 0x06064b50, kLocator64 = 0x07064b50;
constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kLocalBytes = 30;

struct ZipEntry {
  std::string name;
  std::uint16_t method = 0;
  std::uint32_t crc = 0;
  std::uint64_t stored = 0, size = 0, offset = 0;
};

/// Sizes and offset of an entry from its ZIP64 field, where the 32-bit ones say that it has them.
void take_zip64(std::string_view extra, ZipEntry& entry) {
  for (std::uint64_t at = 0; at + 4 <= extra.size();) {
    const auto id = number_at<std::uint16_t>(extra, at);
    const auto length = number_at<std::uint16_t>(extra, at + 2);
    std::uint64_t field = at + 4;
    at += 4ULL + length;
    if (id != 1) continue;
    for (std::uint64_t* value : {&entry.size, &entry.stored, &entry.offset}) {
      if (*value != kIn64) continue;
      *value = number_at<std::uint64_t>(extra, field);
      field += 8;
    }
  }
}

/// Offset of the directory, and its number of entries.
std::pair<std::uint64_t, std::uint64_t> find_directory(std::string_view bytes) {
  const std::string_view signature("PK\x05\x06", 4);
  const auto end = bytes.size() < kEndBytes ? std::string_view::npos : bytes.rfind(signature);
  if (end == std::string_view::npos) throw unreadable("its archive's directory is missing");
  const auto count = number_at<std::uint16_t>(bytes, end + 10);
  const auto offset = number_at<std::uint32_t>(bytes, end + 16);
  const bool has_64 = end >= 20 && number_at<std::uint32_t>(bytes, end - 20) == kLocator64;
  if (!has_64 || (count != 0xffff && offset != kIn64)) return {offset, count};
  const auto at = number_at<std::uint64_t>(bytes, end - 12);
  if (number_at<std::uint32_t>(bytes, at) != kEnd64) throw unreadable("its directory is damaged");
  return {number_at<std::uint64_t>(bytes, at + 48), number_at<std::uint64_t>(bytes, at + 32)};
}

std::vector<ZipEntry> entries_of(std::string_view bytes) {
  auto [at, count] = find_directory(bytes);
  std::vector<ZipEntry> entries;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (number_at<std::uint32_t>(bytes, at) != kEntry) throw unreadable("its directory is damaged");
    const auto name = number_at<std::uint16_t>(bytes, at + 28);
    const auto extra = number_at<std::uint16_t>(bytes, at + 30);
    const auto comment = number_at<std::uint16_t>(bytes, at + 32);
    ZipEntry entry{.name = std::string(part_of(bytes, at + kEntryBytes, name)),
                   .method = number_at<std::uint16_t>(bytes, at + 10),
                   .crc = number_at<std::uint32_t>(bytes, at + 16),
                   .stored = number_at<std::uint32_t>(bytes, at + 20),
                   .size = number_at<std::uint32_t>(bytes, at + 24),
                   .offset = number_at<std::uint32_t>(bytes, at + 42)};
    take_zip64(part_of(bytes, at + kEntryBytes + name, extra), entry);
    entries.push_back(std::move(entry));
    at += kEntryBytes + name + extra + comment;
  }
  return entries;
}

std::string inflated(std::string_view stored, std::uint64_t size) {
  constexpr std::uint64_t kMostRatio = 1032;  // of deflate
  if (size > kMostBytes || size / kMostRatio > stored.size()) {
    throw unreadable("it claims an absurd size");
  }
  std::string bytes(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stored.data()));
  stream.avail_in = static_cast<uInt>(stored.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!whole) throw unreadable("an array of it cannot be decompressed");
  return bytes;
}

std::string content_of(std::string_view bytes, const ZipEntry& entry) {
  if (number_at<std::uint32_t>(bytes, entry.offset) != kLocal) {
    throw unreadable("its archive is damaged");
  }
  const auto name = number_at<std::uint16_t>(bytes, entry.offset + 26);
  const auto extra = number_at<std::uint16_t>(bytes, entry.offset + 28);
  const auto stored = part_of(bytes, entry.offset + kLocalBytes + name + extra, entry.stored);
  if (entry.method != Z_DEFLATED && entry.method != 0) {
    throw unreadable("an array of it is compressed by another method than deflate");
  }
  std::string content = entry.method == 0 ? std::string(stored) : inflated(stored, entry.size);
  const auto* data = reinterpret_cast<const Bytef*>(content.data());
  if (crc32(0, data, static_cast<uInt>(content.size())) != entry.crc) {
    throw unreadable("the checksum of " + entry.name + " is wrong");
  }
  return content;
}

}  // namespace

std::vector<std::pair<std::string, NumpyArray>> read_npz(std::string_view bytes) {
  std::vector<std::pair<std::string, NumpyArray>> arrays;
  for (const ZipEntry& entry : entries_of(bytes)) {
    constexpr std::string_view kExtension = ".npy";
    if (!entry.name.ends_with(kExtension)) continue;
    const std::string name = entry.name.substr(0, entry.name.size() - kExtension.size());
    arrays.emplace_back(name, read_npy(content_of(bytes, entry)));
  }
  if (arrays.empty()) throw unreadable("it holds no array");
  return arrays;
}

}  // namespace wobblebench::bench
