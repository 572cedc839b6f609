#include "bench/exchange/files/npy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "base/text.h"
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
  const bool is_short = descr.size() < 40 && is_printable_text(descr);
  throw std::invalid_argument("holds values of NumPy's type " + (is_short ? descr : "?") +
                              "; must be real numbers, as float32");
}

/// What follows a key of the header's dictionary, in the form in which NumPy writes it.
std::string_view value_of_key(std::string_view text, const std::string& key) {
  const std::size_t at = text.find("'" + key + "':");
  if (at == std::string_view::npos) throw unreadable("its header has no " + key);
  text.remove_prefix(at + key.size() + 3);
  return text.substr(std::min(text.find_first_not_of(' '), text.size()));
}

/// What stands between two marks at the text's beginning.
std::string_view between(std::string_view text, char first, char last) {
  const std::size_t end = text.find(last, 1);
  if (!text.starts_with(first) || end == std::string_view::npos) {
    throw unreadable("its header is damaged");
  }
  return text.substr(1, end - 1);
}

NumpyShape shape_of(std::string_view text) {
  if (text.find_first_not_of("0123456789, ") != std::string_view::npos) {
    throw unreadable("its header is damaged");
  }
  NumpyShape shape;
  std::istringstream words{std::string(text)};
  for (std::string word; std::getline(words >> std::ws, word, ',');) {
    shape.push_back(std::strtoull(word.c_str(), nullptr, 10));  // the greatest of those too great
  }
  return shape;
}

/// Product of the sizes, at most kMostBytes.
std::uint64_t count_of(const NumpyShape& shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t size : shape) {
    if (size != 0 && count > kMostBytes / size) throw unreadable("it claims an absurd size");
    count *= size;
  }
  return count;
}

/// Index in C order of the element with this index in Fortran order.
std::uint64_t c_index(std::uint64_t index, const NumpyShape& shape) {
  std::uint64_t result = 0, stride = count_of(shape);
  for (const std::uint64_t size : shape) {
    stride /= size;
    result += index % size * stride;
    index /= size;
  }
  return result;
}

}  // namespace

NumpyHead read_npy_head(std::string_view bytes) {
  constexpr std::string_view kMagic("\x93NUMPY", 6);
  if (!bytes.starts_with(kMagic)) throw unreadable("it does not begin as one");
  const bool is_first = number_at<std::uint8_t>(bytes, 6) == 1;  // version
  const std::uint64_t start = is_first ? 10 : 12;
  const std::uint64_t length =
      is_first ? number_at<std::uint16_t>(bytes, 8) : number_at<std::uint32_t>(bytes, 8);
  if (start + length > kMostNumpyHead) {
    throw unreadable("its header has " + std::to_string(length) + " bytes, of at most 10000");
  }
  const std::string_view text = part_of(bytes, start, length);
  const std::string_view descr = value_of_key(text, "descr");
  if (descr.starts_with('[')) {
    throw std::invalid_argument("holds records of several fields; must be real numbers");
  }
  NumpyHead head{.type = std::string(between(descr, '\'', '\'')),
                 .fortran = value_of_key(text, "fortran_order").starts_with("True"),
                 .shape = shape_of(between(value_of_key(text, "shape"), '(', ')')),
                 .data_at = start + length};
  head.count = count_of(head.shape);
  head.size = head.data_at + head.count * type_of(head.type).bytes;
  return head;
}

NumpyArray read_npy(std::string_view bytes, const CheckShape& check) {
  const NumpyHead head = read_npy_head(bytes);
  if (head.size > bytes.size()) throw unreadable("it ends too early");
  if (head.size < bytes.size()) throw unreadable("it has bytes behind its end");
  if (check) check(head.shape);
  const ElementType& type = type_of(head.type);
  const bool swap = head.type.front() == '>';
  NumpyArray array{head.type, head.shape, std::vector<double>(head.count)};
  for (std::uint64_t i = 0; i < head.count; ++i) {
    const std::uint64_t to = head.fortran ? c_index(i, head.shape) : i;
    array.values[to] = type.read(bytes.data() + head.data_at + i * type.bytes, swap);
  }
  return array;
}

std::string npy_header(std::span<const std::uint64_t> shape, std::string_view type) {
  constexpr std::size_t kPreamble = 10, kAlignment = 64;
  std::ostringstream dictionary;
  dictionary << "{'descr': '" << (std::endian::native == std::endian::little ? '<' : '>') << type
             << "', 'fortran_order': False, 'shape': (";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    dictionary << (i == 0 ? "" : " ") << shape[i] << (i == 0 || i + 1 < shape.size() ? "," : "");
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
