#include "bench/exchange/files/npz_file.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "bench/exchange/files/npy.h"
#include "bench/exchange/files/numpy_parts.h"

namespace wobblebench::bench {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are");

namespace {

constexpr std::uint16_t kVersion64 = 45;
constexpr std::uint16_t kDay = (1 << 5) | 1;  // 1 January 1980: equal content gives equal bytes

/// Little-endian fields of an archive.
class Fields {
 public:
  template <class... T>
  explicit Fields(T... values) {
    (add(values), ...);
  }
  template <class T>
  void add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::uint64_t item_bytes(const std::string& descr) {
  const std::uint64_t count = std::stoull(descr.substr(2));
  return descr[1] == 'U' ? 4 * count : count;
}

std::string local_header(const std::string& name, std::uint32_t crc, std::uint64_t bytes) {
  Fields fields(std::uint32_t{0x04034b50}, kVersion64, std::uint16_t{0}, std::uint16_t{0});
  fields.add(std::uint16_t{0});  // time
  fields.add(kDay);
  fields.add(crc);
  fields.add(numpy::kIn64);
  fields.add(numpy::kIn64);
  fields.add(static_cast<std::uint16_t>(name.size()));
  fields.add(std::uint16_t{20});
  return fields.bytes() + name + Fields(std::uint16_t{1}, std::uint16_t{16}, bytes, bytes).bytes();
}

std::string directory_entry(const std::string& name,
                            std::uint32_t crc,
                            std::uint64_t bytes,
                            std::uint64_t offset) {
  Fields fields(std::uint32_t{0x02014b50}, kVersion64, kVersion64, std::uint16_t{0});
  fields.add(std::uint16_t{0});  // stored
  fields.add(std::uint16_t{0});
  fields.add(kDay);
  fields.add(crc);
  fields.add(numpy::kIn64);
  fields.add(numpy::kIn64);
  fields.add(static_cast<std::uint16_t>(name.size()));
  fields.add(std::uint16_t{28});
  fields.add(std::uint16_t{0});  // comment
  fields.add(std::uint16_t{0});  // disk
  fields.add(std::uint16_t{0});  // attributes
  fields.add(std::uint32_t{0});
  fields.add(numpy::kIn64);
  return fields.bytes() + name +
         Fields(std::uint16_t{1}, std::uint16_t{24}, bytes, bytes, offset).bytes();
}

std::string directory_end(std::uint64_t entries, std::uint64_t offset, std::uint64_t end) {
  Fields fields(std::uint32_t{0x06064b50}, std::uint64_t{44}, kVersion64, kVersion64);
  fields.add(std::uint32_t{0});
  fields.add(std::uint32_t{0});
  fields.add(entries);
  fields.add(entries);
  fields.add(end - offset);
  fields.add(offset);
  fields.add(std::uint32_t{0x07064b50});
  fields.add(std::uint32_t{0});
  fields.add(end);
  fields.add(std::uint32_t{1});
  fields.add(std::uint32_t{0x06054b50});
  fields.add(std::uint32_t{0});
  fields.add(std::uint16_t{0xffff});
  fields.add(std::uint16_t{0xffff});
  fields.add(numpy::kIn64);
  fields.add(numpy::kIn64);
  fields.add(std::uint16_t{0});
  return fields.bytes();
}

/// NumPy's texts are of 4 bytes a character.
std::vector<char32_t> code_points(const std::string& utf8) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i++]);
    const int more = first < 0xc0 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    char32_t point = more == 0 ? first : first & (0x3fU >> more);
    for (int k = 0; k < more && i < utf8.size(); ++k) {
      point = (point << 6) | (static_cast<unsigned char>(utf8[i++]) & 0x3fU);
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace

void NpzFile::begin(const std::string& name,
                    const std::string& descr,
                    const std::vector<std::uint64_t>& shape) {
  const std::string header = npy_header(shape, descr.substr(1));
  std::uint64_t items = 1;
  for (const auto size : shape) items *= size;
  expected_ = header.size() + items * item_bytes(descr);
  entries_.push_back({name + ".npy", file_.size(), 0, 0});
  file_.write(local_header(entries_.back().name, 0, expected_));
  append(header);
}

void NpzFile::append(std::string_view bytes) {
  Entry& entry = entries_.back();
  entry.crc = static_cast<std::uint32_t>(
      ::crc32_z(entry.crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  entry.bytes += bytes.size();
  file_.write(bytes);
}

void NpzFile::end() {
  const Entry& entry = entries_.back();
  if (entry.bytes != expected_) {
    throw std::logic_error(entry.name + ": " + std::to_string(entry.bytes) + " bytes of " +
                           std::to_string(expected_));
  }
  file_.rewrite(entry.offset, local_header(entry.name, entry.crc, entry.bytes));
}

void NpzFile::texts(const std::string& name, const std::vector<std::string>& values) {
  std::vector<std::vector<char32_t>> points;
  std::size_t longest = 1;
  for (const auto& value : values) {
    points.push_back(code_points(value));
    longest = std::max(longest, points.back().size());
  }
  begin(name, "<U" + std::to_string(longest), {values.size()});
  for (auto& text : points) {
    text.resize(longest);
    append({reinterpret_cast<const char*>(text.data()), longest * sizeof(char32_t)});
  }
  end();
}

void NpzFile::finish() {
  const std::uint64_t offset = file_.size();
  for (const Entry& entry : entries_) {
    file_.write(directory_entry(entry.name, entry.crc, entry.bytes, entry.offset));
  }
  file_.write(directory_end(entries_.size(), offset, file_.size()));
  file_.finish();
}

}  // namespace wobblebench::bench
