#include "bench/exchange/files/numpy_arrays.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMostBytes = 4'000'000'000;

std::invalid_argument unreadable(const std::string& what) {
  return std::invalid_argument("is no readable NumPy file: " + what);
}

/// A number of little-endian bytes at an offset. Throws where the bytes end before.
template <class T>
T number_at(std::string_view bytes, std::uint64_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) {
    throw unreadable("it ends too early");
  }
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

std::string_view part_of(std::string_view bytes, std::uint64_t offset, std::uint64_t count) {
  if (offset > bytes.size() || bytes.size() - offset < count) {
    throw unreadable("it ends too early");
  }
  return bytes.substr(offset, count);
}

// ---- .npy

/// IEEE 754 binary16.
double half_value(std::uint16_t bits) {
  const double sign = (bits & 0x8000) != 0 ? -1 : 1;
  const int exponent = (bits >> 10) & 0x1f;
  const double fraction = bits & 0x3ff;
  if (exponent == 0x1f) return fraction == 0 ? sign * INFINITY : NAN;
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  return sign * std::ldexp(1024 + fraction, exponent - 25);
}

template <class T>
double value_of(const char* bytes, bool swap) {
  char raw[sizeof(T)];
  std::copy_n(bytes, sizeof(T), raw);
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

double half_of(const char* bytes, bool swap) {
  return half_value(static_cast<std::uint16_t>(value_of<std::uint16_t>(bytes, swap)));
}

struct ElementType {
  const char* name;  ///< without the byte order
  std::size_t bytes;
  double (*read)(const char* bytes, bool swap);
};

constexpr ElementType kTypes[] = {{"f4", 4, value_of<float>},
                                  {"f8", 8, value_of<double>},
                                  {"f2", 2, half_of},
                                  {"b1", 1, value_of<std::uint8_t>},
                                  {"u1", 1, value_of<std::uint8_t>},
                                  {"u2", 2, value_of<std::uint16_t>},
                                  {"u4", 4, value_of<std::uint32_t>},
                                  {"u8", 8, value_of<std::uint64_t>},
                                  {"i1", 1, value_of<std::int8_t>},
                                  {"i2", 2, value_of<std::int16_t>},
                                  {"i4", 4, value_of<std::int32_t>},
                                  {"i8", 8, value_of<std::int64_t>}};

const ElementType& type_of(const std::string& descr) {
  for (const ElementType& type : kTypes) {
    if (descr.size() == 3 && descr.substr(1) == type.name) return type;
  }
  throw std::invalid_argument("holds values of NumPy's type " + descr +
                              "; must be real numbers, as float32");
}

struct Header {
  std::string descr;
  bool fortran = false;
  std::vector<std::uint64_t> shape;
};

std::vector<std::uint64_t> shape_of(const std::string& text) {
  static const std::regex number("[0-9]{1,18}");
  std::vector<std::uint64_t> shape;
  for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
    shape.push_back(std::stoull(at->str()));
  }
  return shape;
}

/// The dictionary of the header, in the form in which NumPy writes it.
Header parse_header(const std::string& text) {
  static const std::regex descr("'descr':\\s*'([^']*)'"), order("'fortran_order':\\s*(True|False)"),
      shape("'shape':\\s*\\(([0-9, ]*)\\)");
  std::smatch type, fortran, sizes;
  if (text.find("'descr': [") != std::string::npos) {
    throw std::invalid_argument("holds records of several fields; must be real numbers");
  }
  if (!std::regex_search(text, type, descr) || !std::regex_search(text, fortran, order) ||
      !std::regex_search(text, sizes, shape)) {
    throw unreadable("its header is damaged");
  }
  return {type[1], fortran[1] == "True", shape_of(sizes[1])};
}

/// Product of the sizes, at most kMostBytes.
std::uint64_t count_of(const std::vector<std::uint64_t>& shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t size : shape) {
    if (size != 0 && count > kMostBytes / size) throw unreadable("it claims an absurd size");
    count *= size;
  }
  return count;
}

/// Index in C order of the element with this index in Fortran order.
std::uint64_t c_index(std::uint64_t index, const std::vector<std::uint64_t>& shape) {
  std::uint64_t result = 0, stride = count_of(shape);
  for (const std::uint64_t size : shape) {
    stride /= size;
    result += index % size * stride;
    index /= size;
  }
  return result;
}

// ---- .npz

constexpr std::uint32_t kEntry = 0x02014b50, kLocal = 0x04034b50;
constexpr std::uint32_t kEnd64 = 0x06064b50, kLocator64 = 0x07064b50;
constexpr std::uint32_t kIn64 = 0xffffffff;
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

NumpyArray read_npy(std::string_view bytes) {
  constexpr std::string_view kMagic("\x93NUMPY", 6);
  if (!bytes.starts_with(kMagic)) throw unreadable("it does not begin as one");
  const auto version = number_at<std::uint8_t>(bytes, 6);
  const std::uint64_t start = version == 1 ? 10 : 12;
  const std::uint64_t length =
      version == 1 ? number_at<std::uint16_t>(bytes, 8) : number_at<std::uint32_t>(bytes, 8);
  const std::string text(part_of(bytes, start, std::min<std::uint64_t>(length, 65536)));
  const Header header = parse_header(text);
  const ElementType& type = type_of(header.descr);
  const std::uint64_t count = count_of(header.shape);
  const std::string_view data = part_of(bytes, start + length, count * type.bytes);
  if (start + length + data.size() != bytes.size()) throw unreadable("it has bytes behind its end");
  const bool swap = header.descr.front() == '>';
  NumpyArray array{header.descr, header.shape, std::vector<double>(count)};
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t to = header.fortran ? c_index(i, header.shape) : i;
    array.values[to] = type.read(data.data() + i * type.bytes, swap);
  }
  return array;
}

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

std::string npy_header(std::span<const std::uint64_t> shape, std::string_view type) {
  constexpr std::size_t kPreamble = 10, kAlignment = 64;
  std::ostringstream dictionary;
  dictionary << "{'descr': '" << (std::endian::native == std::endian::little ? '<' : '>') << type
             << "', 'fortran_order': False, 'shape': (" << shape.front() << ',';
  for (std::size_t i = 1; i < shape.size(); ++i) {
    dictionary << ' ' << shape[i] << (i + 1 < shape.size() ? "," : "");
  }
  dictionary << "), }";
  std::string text = dictionary.str();
  const std::size_t unpadded = kPreamble + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  header += text;
  return header;
}

std::string npy_bytes(std::span<const std::uint64_t> shape, std::span<const float> values) {
  std::string bytes = npy_header(shape, "f4");
  const auto data = std::as_bytes(values);
  bytes.append(reinterpret_cast<const char*>(data.data()), data.size());
  return bytes;
}

}  // namespace wobblebench::bench
