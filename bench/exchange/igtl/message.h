// Messages of OpenIGTLink (protocol 1 to 3), as bytes: github.com/openigtlink/OpenIGTLink,
// Documents/Protocol. Numbers are big-endian, lengths millimetres.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wobblebench::bench {

using IgtlMetadata = std::vector<std::pair<std::string, std::string>>;

/// 1: no metadata, which is all that libraries before 3.0 read. 2: with metadata.
enum class IgtlHeaderVersion { one = 1, two = 2 };

/// What every message says beside its content.
struct IgtlHead {
  std::string device;           ///< name of what is sent, at most 20 characters
  std::uint64_t timestamp = 0;  ///< seconds by 2^-32; 0: none
  IgtlMetadata metadata = {};   ///< left out of header version 1
  IgtlHeaderVersion version = IgtlHeaderVersion::two;
};

/// Of seconds that are not negative.
std::uint64_t igtl_timestamp(double seconds);

/// CRC-64 of ECMA-182, without reflection and from 0, of a message's body.
std::uint64_t crc64(std::string_view bytes);

enum class IgtlScalar : std::uint8_t {
  int8 = 2,
  uint8 = 3,
  int16 = 4,
  uint16 = 5,
  int32 = 6,
  uint32 = 7,
  float32 = 10,
  float64 = 11
};

/// The first axis is the fastest.
struct IgtlImage {
  std::array<std::uint16_t, 3> sizes{};
  IgtlScalar scalar = IgtlScalar::uint8;
  int components = 1;
  bool big_endian = false;
  bool lps = false;                   ///< positions are left, posterior, superior; else RAS
  std::array<glm::dvec3, 3> steps{};  ///< one step along each axis, mm
  glm::dvec3 center{0};               ///< of the whole image, mm
  std::string_view voxels;            ///< components of a voxel lie together

  /// Position of the centre of the first voxel, mm.
  glm::dvec3 first_voxel() const;
};

/// Each is a whole message.
std::string igtl_image(const IgtlHead& head, const IgtlImage& image);
/// A rigid motion by the images of the axes and of the origin, mm.
std::string igtl_transform(const IgtlHead& head,
                           const std::array<glm::dvec3, 3>& axes,
                           const glm::dvec3& origin);
/// Points in mm, and triangles of three corners each.
std::string igtl_surface(const IgtlHead& head,
                         std::span<const glm::vec3> points,
                         std::span<const std::int32_t> corners);
/// The status "OK" with a text.
std::string igtl_status(const IgtlHead& head, std::string_view text);

}  // namespace wobblebench::bench
