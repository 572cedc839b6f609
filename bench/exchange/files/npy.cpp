#include "bench/exchange/files/npy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "bench/exchange/files/numpy_parts.h"

namespace wobblebench::bench {

using namespace numpy;

namespace {

static_assert(std::endian::native == std::endian::little);

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
