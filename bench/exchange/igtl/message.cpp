#include "bench/exchange/igtl/message.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "base/unsigned_of.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kTypeBytes = 12, kDeviceBytes = 20, kHeaderBytes = 58;
constexpr std::uint16_t kExtendedHeaderBytes = 12, kUsAscii = 3;  // the latter of IANA's MIBenum
constexpr std::uint16_t kImageVersion = 1, kStatusOk = 1;
constexpr std::size_t kErrorNameBytes = 20;

/// Remainders of bytes at the upper end.
constexpr std::array<std::uint64_t, 256> make_crc_table() {
  constexpr std::uint64_t kPolynomial = 0x42F0E1EBA9EA3693U;
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t byte = 0; byte < 256; ++byte) {
    std::uint64_t rest = byte << 56U;
    for (int bit = 0; bit < 8; ++bit) {
      rest = (rest >> 63U) != 0 ? (rest << 1U) ^ kPolynomial : rest << 1U;
    }
    table[byte] = rest;
  }
  return table;
}

constexpr auto kCrcTable = make_crc_table();

/// A message under way: first its content, then finish().
class Writer {
 public:
  Writer(const IgtlHead& head, const char* type, std::size_t content_bytes)
      : head_(head), type_(type) {
    bytes_.reserve(kHeaderBytes + content_bytes + 4096);
    bytes_.resize(kHeaderBytes);
    if (has_metadata()) bytes_.resize(kHeaderBytes + kExtendedHeaderBytes);
  }

  template <class T>
  void number(T value) {
    append(bytes_, value);
  }
  void vector(const glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) number(static_cast<float>(v[i]));
  }
  void bytes(std::string_view bytes) { bytes_.append(bytes); }
  void text(std::string_view text, std::size_t length) { append_padded(bytes_, text, length); }

  std::string finish() {
    if (has_metadata()) add_metadata();
    std::string header;
    append(header, static_cast<std::uint16_t>(head_.version));
    append_padded(header, type_, kTypeBytes);
    append_padded(header, head_.device, kDeviceBytes);
    append(header, head_.timestamp);
    append(header, static_cast<std::uint64_t>(bytes_.size() - kHeaderBytes));
    append(header, crc64(std::string_view(bytes_).substr(kHeaderBytes)));
    bytes_.replace(0, kHeaderBytes, header);
    return std::move(bytes_);
  }

 private:
  bool has_metadata() const { return head_.version != IgtlHeaderVersion::one; }

  template <class T>
  static void append(std::string& to, T value) {
    const auto bits = std::bit_cast<typename UnsignedOf<sizeof(T)>::type>(value);
    for (std::size_t i = sizeof(T); i-- > 0;) to.push_back(static_cast<char>(bits >> (8 * i)));
  }
  static void append_padded(std::string& to, std::string_view text, std::size_t length) {
    to.append(text.substr(0, length));
    to.append(length - std::min(length, text.size()), '\0');
  }

  void add_metadata() {
    std::string index, values;
    append(index, static_cast<std::uint16_t>(head_.metadata.size()));
    for (const auto& [key, value] : head_.metadata) {
      append(index, static_cast<std::uint16_t>(key.size()));
      append(index, kUsAscii);
      append(index, static_cast<std::uint32_t>(value.size()));
      values.append(key).append(value);
    }
    std::string extended;
    append(extended, kExtendedHeaderBytes);
    append(extended, static_cast<std::uint16_t>(index.size()));
    append(extended, static_cast<std::uint32_t>(values.size()));
    append(extended, std::uint32_t{0});  // of the message; replies name it
    bytes_.replace(kHeaderBytes, kExtendedHeaderBytes, extended);
    bytes_.append(index).append(values);
  }

  const IgtlHead& head_;
  const char* type_;
  std::string bytes_;
};

}  // namespace

std::uint64_t igtl_timestamp(double seconds) {
  const double whole = std::floor(seconds);
  return (static_cast<std::uint64_t>(whole) << 32U) +
         static_cast<std::uint64_t>(std::llround((seconds - whole) * 4294967296.0));
}

std::uint64_t crc64(std::string_view bytes) {
  std::uint64_t crc = 0;
  for (const char byte : bytes) {
    crc = kCrcTable[static_cast<unsigned char>(byte) ^ (crc >> 56U)] ^ (crc << 8U);
  }
  return crc;
}

glm::dvec3 IgtlImage::first_voxel() const {
  glm::dvec3 first = center;
  for (std::size_t i = 0; i < 3; ++i) first -= 0.5 * (sizes.at(i) - 1) * steps.at(i);
  return first;
}

std::string igtl_image(const IgtlHead& head, const IgtlImage& image) {
  Writer writer(head, "IMAGE", image.voxels.size());
  writer.number(kImageVersion);
  writer.number(static_cast<std::uint8_t>(image.components));
  writer.number(static_cast<std::uint8_t>(image.scalar));
  writer.number(static_cast<std::uint8_t>(image.big_endian ? 1 : 2));
  writer.number(static_cast<std::uint8_t>(image.lps ? 2 : 1));
  for (const auto size : image.sizes) writer.number(size);
  for (const glm::dvec3& step : image.steps) writer.vector(step);
  writer.vector(image.center);
  for (int axis = 0; axis < 3; ++axis) writer.number(std::uint16_t{0});  // all of it is sent
  for (const auto size : image.sizes) writer.number(size);
  writer.bytes(image.voxels);
  return writer.finish();
}

std::string igtl_transform(const IgtlHead& head,
                           const std::array<glm::dvec3, 3>& axes,
                           const glm::dvec3& origin) {
  Writer writer(head, "TRANSFORM", 48);
  for (const glm::dvec3& axis : axes) writer.vector(axis);
  writer.vector(origin);
  return writer.finish();
}

std::string igtl_surface(const IgtlHead& head,
                         std::span<const glm::vec3> points,
                         std::span<const std::int32_t> corners) {
  const auto triangles = static_cast<std::uint32_t>(corners.size() / 3);
  Writer writer(head, "POLYDATA", 40 + 12 * points.size() + 16 * std::size_t{triangles});
  writer.number(static_cast<std::uint32_t>(points.size()));
  for (int i = 0; i < 4; ++i) writer.number(std::uint32_t{0});  // no vertices, no lines
  writer.number(triangles);
  writer.number(16 * triangles);                                // bytes
  for (int i = 0; i < 3; ++i) writer.number(std::uint32_t{0});  // no strips, no attributes
  for (const glm::vec3& point : points) writer.vector(point);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i % 3 == 0) writer.number(std::uint32_t{3});
    writer.number(corners[i]);
  }
  return writer.finish();
}

std::string igtl_status(const IgtlHead& head, std::string_view text) {
  Writer writer(head, "STATUS", 31 + text.size());
  writer.number(kStatusOk);
  writer.number(std::int64_t{0});
  writer.text("OK", kErrorNameBytes);
  writer.bytes(text);
  writer.number(std::uint8_t{0});
  return writer.finish();
}

}  // namespace wobblebench::bench
