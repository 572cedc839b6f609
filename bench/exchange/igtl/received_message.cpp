#include "bench/exchange/igtl/received_message.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace wobblebench::bench {

namespace {

constexpr std::size_t kImageHeaderBytes = 72;
constexpr int kLatestHeader = 3;
/// More than any sender has: it is kept in memory.
constexpr std::size_t kMostMetadataBytes = 65536;

/// Reads big-endian numbers one after the other. Throws IgtlRefusal beyond the end.
class BigEndianReader {
 public:
  explicit BigEndianReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Unsigned>
  Unsigned whole() {
    const std::string_view from = take(sizeof(Unsigned));
    Unsigned value = 0;
    for (const char byte : from) {
      value =
          static_cast<Unsigned>((std::uint64_t{value} << 8U) | static_cast<unsigned char>(byte));
    }
    return value;
  }
  glm::dvec3 vector() {
    glm::dvec3 v{0};
    for (int i = 0; i < 3; ++i) {
      v[i] = std::bit_cast<float>(whole<std::uint32_t>());
      if (!std::isfinite(v[i])) throw IgtlRefusal("has a matrix with numbers that are not finite");
    }
    return v;
  }
  /// To its first zero.
  std::string text(std::size_t length) {
    const std::string_view from = take(length);
    return std::string(from.substr(0, from.find('\0')));
  }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw IgtlRefusal("is shorter than it says");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

bool is_printable(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
}

std::map<std::string, std::string> read_metadata(std::string_view index, std::string_view values) {
  std::map<std::string, std::string> metadata;
  if (index.empty() && values.empty()) return metadata;
  BigEndianReader entries(index), texts(values);
  const auto count = entries.whole<std::uint16_t>();
  for (unsigned i = 0; i < count; ++i) {
    const auto key_bytes = entries.whole<std::uint16_t>();
    entries.whole<std::uint16_t>();  // the encoding of the value
    const auto value_bytes = entries.whole<std::uint32_t>();
    std::string key(texts.take(key_bytes));
    metadata[std::move(key)] = std::string(texts.take(value_bytes));
  }
  return metadata;
}

std::array<std::uint16_t, 3> three(BigEndianReader& numbers) {
  std::array<std::uint16_t, 3> values{};
  for (auto& value : values) value = numbers.whole<std::uint16_t>();
  return values;
}

IgtlScalar scalar_of(std::uint8_t number) {
  switch (number) {
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
    case 7:
    case 10:
    case 11:
      return IgtlScalar{number};
    default:
      throw IgtlRefusal("has an unknown type of numbers, " + std::to_string(number));
  }
}

std::uint8_t one_or_two(BigEndianReader& numbers, const char* what) {
  const auto value = numbers.whole<std::uint8_t>();
  if (value == 1 || value == 2) return value;
  throw IgtlRefusal(std::string("has an unknown ") + what + ", " + std::to_string(value));
}

}  // namespace

std::optional<ReceivedHeader> read_igtl_header(std::string_view bytes) {
  BigEndianReader numbers(bytes);
  ReceivedHeader header;
  header.version = numbers.whole<std::uint16_t>();
  header.type = numbers.text(12);
  header.device = numbers.text(20);
  header.timestamp = numbers.whole<std::uint64_t>();
  header.body_bytes = numbers.whole<std::uint64_t>();
  header.crc = numbers.whole<std::uint64_t>();
  const bool is_header = header.version >= 1 && header.version <= kLatestHeader &&
                         !header.type.empty() && is_printable(header.type);
  if (!is_header) return {};
  if (!is_printable(header.device)) header.device.clear();
  return header;
}

ReceivedBody read_igtl_body(const ReceivedHeader& header, std::string_view bytes) {
  if (crc64(bytes) != header.crc) throw IgtlRefusal("has a wrong CRC");
  if (header.version == 1) return {.content = bytes, .metadata = {}};
  BigEndianReader numbers(bytes);
  const auto extended_bytes = numbers.whole<std::uint16_t>();
  const std::size_t index_bytes = numbers.whole<std::uint16_t>();
  const std::size_t value_bytes = numbers.whole<std::uint32_t>();
  numbers = BigEndianReader(bytes);
  numbers.take(extended_bytes);
  const std::string_view rest = numbers.rest();
  if (index_bytes + value_bytes > rest.size()) throw IgtlRefusal("is shorter than it says");
  if (index_bytes + value_bytes > kMostMetadataBytes) throw IgtlRefusal("has too much metadata");
  const std::size_t content_bytes = rest.size() - index_bytes - value_bytes;
  return {.content = rest.substr(0, content_bytes),
          .metadata = read_metadata(rest.substr(content_bytes, index_bytes),
                                    rest.substr(content_bytes + index_bytes))};
}

std::size_t scalar_bytes(IgtlScalar scalar) {
  switch (scalar) {
    case IgtlScalar::int8:
    case IgtlScalar::uint8:
      return 1;
    case IgtlScalar::int16:
    case IgtlScalar::uint16:
      return 2;
    case IgtlScalar::float64:
      return 8;
    default:
      return 4;
  }
}

IgtlImage read_igtl_image(std::string_view content) {
  if (content.size() < kImageHeaderBytes) throw IgtlRefusal("is shorter than it says");
  BigEndianReader numbers(content);
  numbers.whole<std::uint16_t>();  // version: of the format, which has one
  IgtlImage image;
  image.components = numbers.whole<std::uint8_t>();
  image.scalar = scalar_of(numbers.whole<std::uint8_t>());
  image.big_endian = one_or_two(numbers, "byte order") == 1;
  image.lps = one_or_two(numbers, "system of coordinates") == 2;
  image.sizes = three(numbers);
  for (glm::dvec3& step : image.steps) step = numbers.vector();
  image.center = numbers.vector();
  const auto offset = three(numbers), part = three(numbers);
  if (offset != std::array<std::uint16_t, 3>{} || part != image.sizes) {
    throw IgtlRefusal("is a part of an image");
  }
  image.voxels = numbers.rest();
  std::uint64_t needed = scalar_bytes(image.scalar) * static_cast<std::uint64_t>(image.components);
  for (const auto size : image.sizes) needed *= size;  // below 2^60
  if (needed == 0) throw IgtlRefusal("is empty");
  if (needed != image.voxels.size()) throw IgtlRefusal("has not as many voxels as it says");
  return image;
}

}  // namespace wobblebench::bench
