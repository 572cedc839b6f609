#include "bench/exchange/files/kretz.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "base/file.h"
#include "base/units.h"
#include "base/user_error.h"

namespace wobblebench::bench {

static_assert(std::endian::native == std::endian::little, "items are little-endian");

namespace {

constexpr std::string_view kMagic = "KRETZFILE 1.0   ";
constexpr std::size_t kItemHeader = 8;
constexpr std::size_t kMostKretzHeader = 16 << 20;  // before the voxels

/// Group and element of an item.
using Tag = std::pair<std::uint16_t, std::uint16_t>;
constexpr Tag kPatientName{0x0110, 0x0002};
constexpr Tag kSamples{0xC000, 0x0001}, kLines{0xC000, 0x0002}, kFrames{0xC000, 0x0003};
constexpr Tag kResolution{0xC100, 0x0001};                                // m
constexpr Tag kFirstSample{0xC200, 0x0001}, kAxis{0xC200, 0x0002};        // samples
constexpr Tag kFrameAngles{0xC300, 0x0001}, kLineAngles{0xC300, 0x0002};  // rad, middle: pi / 2
constexpr Tag kVoxels{0xD000, 0x0001};

struct Items {
  const std::filesystem::path& path;
  std::map<Tag, std::string> data;  ///< of all before the voxels
  std::uint64_t voxels_at = 0;
  std::uint64_t voxels_bytes = 0;

  template <class T>
  std::vector<T> values(const Tag& tag, const char* what) const {
    const auto found = data.find(tag);
    if (found == data.end() || found->second.size() < sizeof(T)) {
      throw UserError(path.string() + ": does not say " + what + "; must be a polar volume");
    }
    std::vector<T> values(found->second.size() / sizeof(T));
    std::memcpy(values.data(), found->second.data(), values.size() * sizeof(T));
    return values;
  }
  double number(const Tag& tag, const char* what, double most) const {
    const double value = values<double>(tag, what).front();
    if (std::isfinite(value) && std::abs(value) <= most) return value;
    throw UserError(path.string() + ": " + what + " is out of range");
  }
};

Items read_items(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kMostKretzHeader);
  if (!bytes.starts_with(kMagic)) throw UserError(path.string() + ": is no KRETZFILE 1.0");
  Items items{.path = path, .data = {}};
  std::size_t at = kMagic.size();
  while (at + kItemHeader <= bytes.size()) {
    std::uint16_t group = 0, element = 0;
    std::uint32_t size = 0;
    std::memcpy(&group, bytes.data() + at, 2);
    std::memcpy(&element, bytes.data() + at + 2, 2);
    std::memcpy(&size, bytes.data() + at + 4, 4);
    at += kItemHeader;
    if (Tag(group, element) == kVoxels) {
      items.voxels_at = at;
      items.voxels_bytes = size;
      return items;
    }
    if (size > bytes.size() - at) break;
    items.data[{group, element}] = bytes.substr(at, size);
    at += size;
  }
  throw UserError(path.string() +
                  ": holds no uncompressed voxels (item D000,0001); must be saved without "
                  "compression");
}

std::vector<double> angles(const Items& items,
                           const Tag& tag,
                           const char* what,
                           std::uint64_t count) {
  std::vector<double> angles = items.values<double>(tag, what);
  bool good = angles.size() == count;
  for (double& angle : angles) {
    angle -= 0.5 * kPi;
    good = good && std::abs(angle) < 0.5 * kPi;
  }
  if (good) return angles;
  throw UserError(items.path.string() + ": " + what + ": must be " + std::to_string(count) +
                  " angles between 0 and pi");
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string item(const Tag& tag, std::size_t size) {
  return bytes_of(std::vector<std::uint16_t>{tag.first, tag.second}) +
         bytes_of(std::vector<std::uint32_t>{static_cast<std::uint32_t>(size)});
}
std::string item(const Tag& tag, const std::string& data) {
  return item(tag, data.size()) + data;
}

}  // namespace

KretzScan read_kretz(const std::filesystem::path& path) {
  const Items items = read_items(path);
  KretzScan scan;
  scan.file = {.path = path, .data_path = path, .offset = items.voxels_at};
  for (const auto& [tag, what] : {std::pair(kSamples, "the number of samples"),
                                  std::pair(kLines, "the number of lines"),
                                  std::pair(kFrames, "the number of frames")}) {
    scan.file.sizes.push_back(items.values<std::uint16_t>(tag, what).front());
  }
  const std::uint64_t voxels = scan.file.voxels();
  if (voxels == 0 || voxels != items.voxels_bytes) {
    throw UserError(path.string() + ": has voxels of " + std::to_string(items.voxels_bytes) +
                    " bytes; must be one for each of " + std::to_string(voxels));
  }
  std::error_code error;
  if (std::filesystem::file_size(path, error) < items.voxels_at + voxels) {
    throw UserError(path.string() + ": ends before its last voxel");
  }
  scan.resolution_m = items.number(kResolution, "the distance of samples", 0.1);
  if (scan.resolution_m <= 0) {
    throw UserError(path.string() + ": the distance of samples is out of range");
  }
  scan.first_m =
      scan.resolution_m * items.number(kFirstSample, "the range of the first sample", 1e6);
  scan.axis_m = -scan.resolution_m * items.number(kAxis, "the place of the motor's axis", 1e6);
  scan.line_rad = angles(items, kLineAngles, "the angles of the lines", scan.file.sizes[1]);
  scan.frame_rad = angles(items, kFrameAngles, "the angles of the frames", scan.file.sizes[2]);
  return scan;
}

std::string kretz_text(const KretzScan& scan, const std::string& source) {
  const auto size = [&](std::size_t axis) {
    return bytes_of(std::vector<std::uint16_t>{static_cast<std::uint16_t>(scan.file.sizes[axis])});
  };
  const auto number = [](double value) { return bytes_of(std::vector<double>{value}); };
  const auto about_middle = [](std::vector<double> angles) {
    for (double& angle : angles) angle += 0.5 * kPi;
    return bytes_of(angles);
  };
  return std::string(kMagic) + item(kPatientName, source + '\0') + item(kSamples, size(0)) +
         item(kLines, size(1)) + item(kFrames, size(2)) +
         item(kResolution, number(scan.resolution_m)) +
         item(kFirstSample, number(scan.first_m / scan.resolution_m)) +
         item(kAxis, number(-scan.axis_m / scan.resolution_m)) +
         item(kFrameAngles, about_middle(scan.frame_rad)) +
         item(kLineAngles, about_middle(scan.line_rad)) + item(kVoxels, scan.file.voxels());
}

}  // namespace wobblebench::bench
