#include "bench/exchange/files/npz_reader.h"

#include <zlib.h>

#include <algorithm>
#include <map>
#include <utility>

#include "bench/exchange/files/inflate.h"
#include "bench/exchange/files/numpy_parts.h"

namespace wobblebench::bench {

using namespace numpy;

namespace {

constexpr std::uint32_t kEntry = 0x02014b50, kLocal = 0x04034b50;
constexpr std::uint32_t kEnd64 = 0x06064b50, kLocator64 = 0x07064b50;
constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kLocalBytes = 30;

/// Sizes and offset of an entry from its ZIP64 field, where the 32-bit ones say that it has them.
void take_zip64(std::string_view extra, NpzEntry& entry) {
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

/// Finds what the entries hold.
void find_contents(std::string_view bytes, std::vector<NpzEntry>& entries) {
  std::map<std::uint64_t, std::uint64_t> ends;  // by where entries begin
  for (NpzEntry& entry : entries) {
    if (number_at<std::uint32_t>(bytes, entry.offset) != kLocal) {
      throw unreadable("its archive is damaged");
    }
    const auto name = number_at<std::uint16_t>(bytes, entry.offset + 26);
    const auto extra = number_at<std::uint16_t>(bytes, entry.offset + 28);
    const std::uint64_t at = entry.offset + kLocalBytes + name + extra;
    entry.content = part_of(bytes, at, entry.stored);
    if (!ends.emplace(entry.offset, at + entry.stored).second) throw unreadable("arrays overlap");
  }
  std::uint64_t last = 0;
  for (const auto& [begin, end] : ends) {
    if (begin < std::exchange(last, end)) throw unreadable("arrays overlap");
  }
}

}  // namespace

std::vector<NpzEntry> npz_entries(std::string_view bytes) {
  auto [at, count] = find_directory(bytes);
  std::vector<NpzEntry> entries;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (number_at<std::uint32_t>(bytes, at) != kEntry) throw unreadable("its directory is damaged");
    const auto name = number_at<std::uint16_t>(bytes, at + 28);
    const auto extra = number_at<std::uint16_t>(bytes, at + 30);
    const auto comment = number_at<std::uint16_t>(bytes, at + 32);
    NpzEntry entry{.name = std::string(part_of(bytes, at + kEntryBytes, name)),
                   .method = number_at<std::uint16_t>(bytes, at + 10),
                   .crc = number_at<std::uint32_t>(bytes, at + 16),
                   .stored = number_at<std::uint32_t>(bytes, at + 20),
                   .size = number_at<std::uint32_t>(bytes, at + 24),
                   .offset = number_at<std::uint32_t>(bytes, at + 42)};
    take_zip64(part_of(bytes, at + kEntryBytes + name, extra), entry);
    at += kEntryBytes + name + extra + comment;
    constexpr std::string_view kExtension = ".npy";
    if (!entry.name.ends_with(kExtension)) continue;
    entry.name.resize(entry.name.size() - kExtension.size());
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) throw unreadable("it holds no array");
  find_contents(bytes, entries);
  return entries;
}

NumpyArray read_npz(const NpzEntry& entry, const CheckShape& check) {
  if (entry.method != Z_DEFLATED && entry.method != 0) {
    throw unreadable("an array of it is compressed by another method than deflate");
  }
  std::string unpacked;
  if (entry.method == Z_DEFLATED) {
    const auto first = std::min<std::uint64_t>(entry.size, kMostNumpyHead);
    const NumpyHead head = read_npy_head(inflated(entry.content, first, kBareDeflate, false));
    if (head.size != entry.size) throw unreadable(entry.name + " has another size than it says");
    if (check) check(head.shape);
    unpacked = inflated(entry.content, entry.size, kBareDeflate, true);
  }
  const std::string_view content = entry.method == 0 ? entry.content : unpacked;
  const auto* data = reinterpret_cast<const Bytef*>(content.data());
  if (crc32_z(0, data, content.size()) != entry.crc) {
    throw unreadable("the checksum of " + entry.name + " is wrong");
  }
  return read_npy(content, check);
}

}  // namespace wobblebench::bench
